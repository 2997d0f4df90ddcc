#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace alabaster {

/// Scattering orders 0 .. 2^20 - 1 in groups: singly below 64, then 32 groups per octave, so that within a
/// group alpha^n varies by at most (1 - alpha) n / 32.
struct OrderGroups {
  static constexpr int64_t limit = int64_t{1} << 20;  // orders tallied: below this
  static constexpr int singles = 64, per_octave = 32, log2_singles = 6;
  static constexpr int count = singles + (20 - log2_singles) * per_octave;

  static int index(int64_t order) {
    if (order < singles) return static_cast<int>(order);
    const int octave = static_cast<int>(std::bit_width(static_cast<uint64_t>(order))) - 1;
    const int part = static_cast<int>((order >> (octave - 5)) & (per_octave - 1));
    return singles + (octave - log2_singles) * per_octave + part;
  }
  /// First order of a group; first(count) is `limit`.
  static int64_t first(int group) {
    if (group < singles) return group;
    const int octave = (group - singles) / per_octave, part = (group - singles) % per_octave;
    return int64_t{per_octave + part} << (octave + 1);
  }
  static int64_t width(int group) { return first(group + 1) - first(group); }

  /// Mean of alpha^(n - 1) over the orders n of a group (n >= 1).
  static double mean_power(int group, double albedo) {
    const double start = static_cast<double>(first(group)), n = static_cast<double>(width(group));
    if (albedo <= 0) return group == 1 ? 1.0 : 0.0;
    if (albedo >= 1) return 1;
    const double log_albedo = std::log(albedo);
    const double first_power = std::exp((start - 1) * log_albedo);
    return n == 1 ? first_power : first_power * std::expm1(n * log_albedo) / (n * std::expm1(log_albedo));
  }
};

}  // namespace alabaster
