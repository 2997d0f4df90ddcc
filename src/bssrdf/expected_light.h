#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/vec.h"

namespace alabaster {

/// Light on a surface, unoccluded and in few steps: tells which entries are worth following. A guide only, so
/// its errors cost time or noise, never truth. Immutable.
class ExpectedLight {
 public:
  /// What comes from about one direction.
  struct Distant {
    Vec3 direction;     // unit, towards the light
    double irradiance;  // on a surface that faces it, W/m^2
  };
  /// A light at a place. It shines in full where the cosine to its axis exceeds `full`, not at all below
  /// `none`, and in proportion in between.
  struct Lamp {
    Vec3 position;
    double intensity;  // W/sr, along the axis
    Vec3 axis{0};      // unit, the way it shines; 0: all ways
    double none = -1, full = 0;
    double size = 0;  // m: as bright as from there where one is nearer
  };
  explicit ExpectedLight(std::span<const Distant> lights, std::span<const Lamp> lamps = {});

  /// Mean irradiance over all normals at a place, W/m^2.
  double mean(const Vec3& position) const;
  /// Irradiance on a surface of that unit normal there over `mean`; at least a twentieth, and 1 without any
  /// light. Without lamps `mean` is taken for mean(), the same everywhere.
  double relative(const Vec3& position, const Vec3& normal, double mean) const;
  /// Mean of the directions that light on it comes from, each by its irradiance: the shorter the more they
  /// differ, 0 without any light.
  Vec3 direction(const Vec3& position, const Vec3& normal) const;

 private:
  static std::size_t cell(const Vec3& normal);

  static constexpr int side = 32;  // of the octahedron's map
  double distant_mean_ = 0;
  std::array<float, side * side> relative_{};
  std::array<Vec3f, side * side> direction_{};
  std::vector<Lamp> lamps_;
};

}  // namespace alabaster
