#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace alabaster {

/// The transfer function of sRGB, IEC 61966-2-1, for one channel; values outside [0, 1] are
/// continued by the same formulas.
inline double srgb_to_linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}
inline double linear_to_srgb(double linear) {
  return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// Linear to an 8-bit sRGB code, clamped to [0, 255]; NaN becomes 0.
inline uint8_t linear_to_srgb8(double linear) {
  if (!(linear > 0)) return 0;
  return static_cast<uint8_t>(std::lround(255 * linear_to_srgb(std::min(linear, 1.0))));
}

}  // namespace alabaster
