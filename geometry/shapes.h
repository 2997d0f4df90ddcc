#pragma once

#include "geometry/mesh.h"

namespace alabaster {

// Procedural meshes with smooth normals and UVs, for assets, studies and tests. Closed shapes are wound
// outwards. `resolution` is the number of segments of the longest direction.

/// Square in the plane z = 0, side `size`, centre at the origin, normal +z, UV (0, 0) at (-, +) as glTF
/// images run.
TriangleMesh make_plane(double size, int resolution = 1);
/// Latitude-longitude sphere, poles on y.
TriangleMesh make_sphere(double radius, int resolution = 128);
/// The sphere turned inside out within a box: medium outside a ball.
TriangleMesh make_cavity(double radius, double box_half_size, int resolution = 128);
TriangleMesh make_cylinder(double radius, double length, int resolution = 128);  // closed by caps, axis y
TriangleMesh make_ellipsoid(const Vec3& semi_axes, int resolution = 128);
TriangleMesh make_torus(double ring_radius, double tube_radius, int resolution = 192);  // axis y
/// Unit sphere with bumps, UVs in a multi-chart atlas (six faces of a cube, with gutters).
TriangleMesh make_blob(double radius, double bump, int resolution = 128);
TriangleMesh make_slab(double width, double thickness,
                       int resolution = 32);  // closed box, faces at y = +-thickness/2
/// A sheet of some thickness folded over so that two layers nearly touch.
TriangleMesh make_folded_sheet(double width, double thickness, double gap, int resolution = 64);

}  // namespace alabaster
