#pragma once

#include <vector>

#include "core/vec.h"
#include "geometry/mesh.h"

namespace alabaster {

/// For each triangle the unit direction that the surface faces on the whole within about `scale` metres,
/// whatever bumps are smaller than that; its own normal where the surroundings do not agree on a direction
/// (thin sheets, bodies smaller than the scale) or turn away from it. Time and memory are linear in the
/// triangles.
std::vector<Vec3f> smoothed_normals(const TriangleMesh& mesh, double scale);

}  // namespace alabaster
