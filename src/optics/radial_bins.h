#pragma once

#include <algorithm>
#include <cmath>

#include "core/vec.h"

namespace alabaster {

/// Optical distances in bins of equal ratio, 16 per octave, from 2^-10 to 2^13 mean free paths; what lies
/// nearer or farther goes to a bin at either end.
struct RadialBins {
  static constexpr int per_octave = 16, first_octave = -10, last_octave = 13;
  static constexpr int inner = (last_octave - first_octave) * per_octave;
  static constexpr int count = inner + 2;

  /// Bin of a distance given its square.
  static int index_of_square(double rho_squared) {
    const double x = 0.5 * std::log2(static_cast<float>(rho_squared)) - first_octave;
    return static_cast<int>(std::clamp(std::floor(x * per_octave), -1.0, double{inner})) + 1;
  }
  /// Lower edge of a bin; edge(0) is 0 and edge(count) infinite.
  static double edge(int bin) {
    if (bin == 0) return 0;
    if (bin == count) return HUGE_VAL;
    return std::exp2(static_cast<double>(bin - 1) / per_octave + first_octave);
  }
  static double centre(int bin) {
    return std::exp2((static_cast<double>(bin) - 0.5) / per_octave + first_octave);
  }
  static double width(int bin) { return edge(bin + 1) - edge(bin); }
};

}  // namespace alabaster
