#pragma once

#include "geometry/mesh.h"

namespace alabaster {

/// Renumbers triangles, positions and attributes so that what is close in space is close in memory: triangles
/// along a Morton curve through their centroids, the rest in the order in which triangles use them. The
/// surface stays what it was; positions and attributes that no triangle uses are dropped. Large meshes are
/// rendered faster so, since what one entry's surroundings need fits into the caches.
void sort_in_space(TriangleMesh& mesh);

}  // namespace alabaster
