#pragma once

#include "geometry/mesh.h"

namespace alabaster {

// Procedural meshes with smooth normals and UVs, for assets, studies and tests. Closed shapes are wound
// outwards, every position stands once, normals are those of the exact surface. `resolution` is the number of
// segments of the longest direction. Seen from outside, u runs to the right and v downwards (no chart is
// mirrored). Lengths in metres; positive, unless another range is given.

/// Width of the empty margin around the charts of shapes that have several, in UV units.
inline constexpr double shape_gutter = 1.0 / 64;

/// Square in the plane z = 0, side `size`, centre at the origin, normal +z, UV (0, 0) at (-, +) as glTF
/// images run.
TriangleMesh make_plane(double size, int resolution = 1);
/// Latitude-longitude sphere, poles on y; u once around from -z, v from the north pole to the south pole.
TriangleMesh make_sphere(double radius, int resolution = 128);
/// The sphere turned inside out within a box: medium outside a ball. radius < box_half_size.
TriangleMesh make_cavity(double radius, double box_half_size, int resolution = 128);
/// Closed by caps, hard rims, axis y; side and caps are three charts of one scale.
TriangleMesh make_cylinder(double radius, double length, int resolution = 128);
/// As the sphere, each axis scaled.
TriangleMesh make_ellipsoid(const Vec3& semi_axes, int resolution = 128);
/// Axis y, tube_radius < ring_radius; u once around the ring, v once around the tube, so textures wrap.
TriangleMesh make_torus(double ring_radius, double tube_radius, int resolution = 192);
/// Sphere with smooth bumps of relative height `bump` (at most 0.5), UVs in a multi-chart atlas (six faces of
/// a cube, with gutters).
TriangleMesh make_blob(double radius, double bump, int resolution = 128);
/// Closed square box with faces at y = +-thickness/2, hard edges, six charts of one scale.
TriangleMesh make_slab(double width, double thickness, int resolution = 32);
/// A sheet folded over: two layers of side `width`, with `gap` between them, joined by a half-circular bend
/// at -x; the fold runs along z. Closed, hard edges, six charts.
TriangleMesh make_folded_sheet(double width, double thickness, double gap, int resolution = 64);

}  // namespace alabaster
