#pragma once

#include "optics/fast_math.h"
#include "optics/table_data.h"

namespace alabaster {

/// Positions among the rows, 0 to rows - 1, in two steps: of `root`, the square root of 1 - albedo, the
/// number whose logarithm is wanted, and the position given that.
template <typename Float>
inline Float row_position_argument(Float root) {
  constexpr auto inverse_knee = static_cast<float>(1 / AlbedoRows::knee);
  return 1.f + root * inverse_knee;
}
template <typename Float>
inline Float row_position(Float log2_argument, Float root) {
  constexpr auto scale = static_cast<float>((AlbedoRows::count - 1) / AlbedoRows::length);
  return scale * (log2_argument + static_cast<float>(AlbedoRows::linear) * root);
}

/// Position among the rows of the albedo 1 - remainder, 0 to rows - 1.
template <typename Float>
inline Float fast_row_position(Float remainder) {
  const Float root = square_root(remainder);
  return row_position(fast_log2(row_position_argument(root)), root);
}

}  // namespace alabaster
