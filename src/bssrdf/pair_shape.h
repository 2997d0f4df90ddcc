#pragma once

#include "core/vec.h"
#include "geometry/curvature.h"
#include "optics/shape_families.h"

namespace alabaster {

/// Mean free paths: a body thicker than this counts as having nothing behind.
inline constexpr double thickest_body = 1024;

/// Mean free paths: over this neighbourhood wrinkles count as roughness (CurvatureOptions::coarse_radius).
inline constexpr double coarse_radius = 4;

/// What the shape basis asks of one point, read once. Lengths in metres.
struct PointShape {
  Vec3 normal{0};                               // unit, outwards, of the smoothed surface
  double curvature_min = 0, curvature_max = 0;  // 1/m, convex positive
  double inverse_thickness = 0;                 // 1/m
  double sphericity = 0;                        // [0, 1]
  double bend_square = 0;                       // 1/m^2: mean square of the principal curvatures
  double roughness = 0;                         // LocalShape's
  double coarse_distance = 0;                   // m: from here on pairs see the smoothed surface

  PointShape() = default;
  /// `thickest` (m) is what counts as nothing behind.
  PointShape(const LocalShape& local, double thickest);
};

/// The body that a pair of points takes itself to be on: symmetric in the two. docs/shape_basis.md has the
/// reasons.
PairShape pair_shape(const Vec3& entry, const PointShape& at_entry, const Vec3& exit,
                     const PointShape& at_exit);

}  // namespace alabaster
