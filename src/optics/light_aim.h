#pragma once

#include <array>

#include "core/rgb.h"
#include "core/vec.h"

namespace alabaster {

/// How light by its directions gets from an entry to an exit, over the mean of all directions: light that is
/// aimed at the exit is favoured. With t the difference of the directions' parts within the surface, towards
/// the light at the entry less towards the viewer at the exit, and u the unit vector from the exit to the
/// entry, the factor is exp(k t . u) / I_0(k |t|), von Mises' distribution of the azimuth of u. It is
/// positive, the same with both ends exchanged, and its mean over all azimuths of u is 1 for every pair of
/// directions: on a surface under even light, directions change nothing. On bodies t . u is taken with u's
/// part within the surface at either end.
class LightAim {
 public:
  /// No aim: a factor of 1.
  LightAim() = default;
  /// Concentrations k (>= 0, at most AimSlopes::largest); normals outwards; `viewer` unit, from the exit.
  LightAim(const Rgb& concentration, const Vec3& entry, const Vec3& entry_normal, const Vec3& exit,
           const Vec3& exit_normal, const Vec3& viewer);

  /// Whether the factor is 1 for all directions.
  bool is_even() const { return concentration_.is_black(); }
  /// The factor for light that comes from `direction` (unit, outwards).
  Rgb at(const Vec3& direction) const;
  /// Its mean over the light that enters from a uniform hemisphere: six directions, good to 1 %.
  Rgb mean() const;

 private:
  Rgb factor(double along, double across) const;

  Rgb concentration_{0};
  Vec3 along_{0}, across_{0};                    // u and n x u, within the surface at the entry
  double viewer_along_ = 0, viewer_across_ = 0;  // the viewer's parts along the exit's
};

/// Between concentrations and slopes b: the mean of w . u over its mean square (w towards the light, u in the
/// surface, Fresnel-weighted cosines at both ends), which walks measure (aim_bake.h). For small k they are
/// the same.
class AimSlopes {
 public:
  /// Steeper slopes than this one's, 0.97, are taken for it: on images they only add noise
  /// (docs/shape_basis.md).
  static constexpr double largest = 1.2;
  explicit AimSlopes(double eta);
  double slope(double concentration) const;
  double concentration(double slope) const;

 private:
  static constexpr int steps = 50;
  std::array<double, steps + 1> slopes_;  // at equal steps of concentration from 0 to the largest
};

}  // namespace alabaster
