#pragma once

#include "geometry/mesh.h"

namespace alabaster {

// The pieces of the demonstration: shapes with thin and thick parts, and what they stand on. Metres, y up.

/// A footed bowl whose wall is a wreath of lotus petals, about 0.2 m across and 0.13 m high, standing on y =
/// 0: 2 mm thin at the petals' rims and along the grooves between them, 20 mm at the base. One closed surface
/// of `columns` x `rows` quads; UVs go once around (u wraps) and from the foot over the rim to the inner
/// bottom.
TriangleMesh make_lotus_bowl(int columns = 216, int rows = 120);

/// A sheet that runs from the front as a floor at y = 0, bends up, and ends as a wall behind z = -depth / 2;
/// open. `bend_radius` is at most depth and height.
TriangleMesh make_backdrop(double width, double depth, double height, double bend_radius);

/// The mesh under p -> linear p + offset; linear must not mirror.
TriangleMesh transformed(TriangleMesh mesh, const Mat3& linear, const Vec3& offset);

}  // namespace alabaster
