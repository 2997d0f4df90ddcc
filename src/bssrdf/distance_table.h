#pragma once

#include <cstdint>
#include <vector>

#include "optics/profile_table.h"

namespace alabaster {

/// Optical distances drawn from a profile's whole range, for any albedo, without evaluating the profile: per
/// albedo level a density that is constant within narrow bins (16 per octave, so bin and density are read off
/// the bits of the distance) and falls as 1/rho^2 beyond the last. pdf() is exactly what sample() draws from;
/// both follow 2 pi rho R(rho; alpha) / A(alpha) to a few per cent, at the next brighter level. Immutable and
/// thread-safe.
class DistanceTable {
 public:
  explicit DistanceTable(const ProfileTable& profile);

  /// Levels are spaced in (1 - albedo)^(1/4); the one chosen is the nearest that is not darker.
  static int level(double albedo);
  static double albedo(int level);
  static constexpr int level_count = 49;

  /// u in [0, 1); increasing in u.
  double sample(int level, double u) const;
  /// Per unit optical distance, positive for rho >= 0.
  double pdf(int level, double rho) const;
  /// P(distance <= rho).
  double cdf(int level, double rho) const;

 private:
  std::vector<double> density_;     // level x bin, per unit rho
  std::vector<double> cumulative_;  // level x bin edge
};

}  // namespace alabaster
