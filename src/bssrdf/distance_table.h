#pragma once

#include <algorithm>
#include <bit>
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
  double pdf(int level, double rho) const {
    const int bin = bin_of(rho);
    const double density = density_[row_begin(level) + static_cast<std::size_t>(bin)];
    return bin < bin_count ? density : density / (rho * rho);
  }
  /// P(distance <= rho).
  double cdf(int level, double rho) const;

 private:
  // Bin 0 is [0, 2^first_octave), where the density is flat: R ~ 1/rho. Then 16 bins per octave, as the four
  // leading bits of the mantissa count them, up to 2^last_octave; the rest falls as 1/rho^2.
  static constexpr int first_octave = -10, last_octave = 14, bins_per_octave = 16;
  static constexpr int bin_count = (last_octave - first_octave) * bins_per_octave + 1;
  static constexpr int mantissa_shift = 52 - 4;
  static constexpr int64_t first_code = int64_t{1023 + first_octave} * bins_per_octave;

  /// Where a level's bins begin in the tables.
  static std::size_t row_begin(int level) { return static_cast<std::size_t>(level) * (bin_count + 1); }
  static int bin_of(double rho) {
    const auto code = static_cast<int64_t>(std::bit_cast<uint64_t>(rho) >> mantissa_shift) - first_code + 1;
    return static_cast<int>(std::clamp<int64_t>(code, 0, bin_count));
  }
  /// Lower edge of a bin.
  static double edge(int bin) {
    if (bin == 0) return 0;
    return std::bit_cast<double>(static_cast<uint64_t>(first_code + bin - 1) << mantissa_shift);
  }
  static std::vector<double> bin_masses(const ProfileTable& profile, double albedo);

  std::vector<double> density_;     // level x bin, per unit rho
  std::vector<double> cumulative_;  // level x bin edge
};

}  // namespace alabaster
