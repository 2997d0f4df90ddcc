#pragma once

#include "optics/fast_math.h"
#include "optics/table_data.h"

namespace alabaster {

/// Position among the rows of the albedo 1 - remainder, 0 to rows - 1.
template <typename Float>
inline Float fast_row_position(Float remainder) {
  constexpr auto inverse_knee = static_cast<float>(1 / AlbedoRows::knee);
  constexpr auto scale = static_cast<float>((AlbedoRows::count - 1) / AlbedoRows::length);
  const Float root = square_root(remainder);
  return scale * (fast_log2(1.f + root * inverse_knee) + static_cast<float>(AlbedoRows::linear) * root);
}

}  // namespace alabaster
