#pragma once

#include <bit>
#include <cstdint>

// Single-precision logarithm and exponential without branches or tables, for code that the compiler
// vectorises. Only exactly rounded operations: the same result on every machine.

namespace alabaster {

/// ln(x) for normal x > 0, error below 3e-7 (absolute or relative, whichever is larger): x = 2^e m, m in
/// [sqrt(1/2), sqrt(2)), ln m = 2 atanh((m - 1)/(m + 1)), the series cut at 2e-9.
inline float fast_log(float x) {
  const auto bits = std::bit_cast<int32_t>(x);
  const int32_t exponent = (bits - 0x3f3504f3) >> 23;
  const float m = std::bit_cast<float>(bits - (exponent << 23));
  const float s = (m - 1) / (m + 1), s2 = s * s;
  const float series = 1 + s2 * (1.f / 3 + s2 * (1.f / 5 + s2 * (1.f / 7 + s2 * (1.f / 9))));
  return 0.693147181f * static_cast<float>(exponent) + 2 * s * series;
}

inline float fast_log2(float x) {
  return 1.44269504f * fast_log(x);
}

/// 2^x, relative error below 3e-7 for |x| < 8 (rounding of x itself beyond); x is clamped to [-126, 126].
inline float fast_exp2(float x) {
  x = x < -126.f ? -126.f : x;
  x = x > 126.f ? 126.f : x;
  const auto whole = static_cast<int32_t>(x + 126.5f) - 126;  // rounds to nearest: the argument is positive
  const float y = 0.693147181f * (x - static_cast<float>(whole));
  const float power =
      1 + y * (1 + y * (1.f / 2 + y * (1.f / 6 + y * (1.f / 24 + y * (1.f / 120 + y * (1.f / 720))))));
  return power * std::bit_cast<float>((whole + 127) << 23);
}

}  // namespace alabaster
