#pragma once

#include <array>
#include <span>

#include "core/vec.h"

namespace alabaster {

/// Light from far away on surfaces of any direction, unoccluded and in few steps: tells which entries are
/// worth following. A guide only, so its errors cost time or noise, never truth. Immutable.
class ExpectedLight {
 public:
  /// What comes from about one direction.
  struct Distant {
    Vec3 direction;     // unit, towards the light
    double irradiance;  // on a surface that faces it
  };
  explicit ExpectedLight(std::span<const Distant> lights);

  /// Irradiance on a surface of that unit normal over the mean of all normals; at least a twentieth, and 1
  /// without any light.
  double relative(const Vec3& normal) const;
  /// Mean of the directions that light on it comes from, each by its irradiance: the shorter the more they
  /// differ, 0 without any light.
  Vec3 direction(const Vec3& normal) const;

 private:
  static std::size_t cell(const Vec3& normal);

  static constexpr int side = 32;  // of the octahedron's map
  std::array<float, side * side> relative_{};
  std::array<Vec3f, side * side> direction_{};
};

}  // namespace alabaster
