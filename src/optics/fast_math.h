#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

// Single-precision logarithm and exponential without branches or tables, for one number or four at once. Only
// exactly rounded operations: the same result on every machine.

namespace alabaster {

/// Four lanes (vector extension of GCC and Clang; any CPU).
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

inline int32_t to_integer(float x) {
  return static_cast<int32_t>(x);
}
inline Int4 to_integer(Float4 x) {
  return __builtin_convertvector(x, Int4);
}
inline float to_float(int32_t i) {
  return static_cast<float>(i);
}
inline Float4 to_float(Int4 i) {
  return __builtin_convertvector(i, Float4);
}
inline int32_t bits_of(float x) {
  return std::bit_cast<int32_t>(x);
}
inline Int4 bits_of(Float4 x) {
  return reinterpret_cast<Int4>(x);
}
inline float from_bits(int32_t i) {
  return std::bit_cast<float>(i);
}
inline Float4 from_bits(Int4 i) {
  return reinterpret_cast<Float4>(i);
}
inline float square_root(float x) {
  return std::sqrt(x);
}
inline Float4 square_root(Float4 x) {
#ifdef __SSE__
  return _mm_sqrt_ps(x);
#else
  return Float4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
#endif
}
/// Four consecutive numbers, unaligned.
inline Float4 load4(const float* from) {
  Float4 result;
  std::memcpy(&result, from, sizeof result);
  return result;
}
/// Rows become columns.
inline void transpose(Float4& a, Float4& b, Float4& c, Float4& d) {
  const Float4 ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5),
               ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Float4 cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5),
               cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  c = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

/// ln(x) for normal x > 0, error below 3e-7 (absolute or relative, whichever is larger): x = 2^e m, m in
/// [sqrt(1/2), sqrt(2)), ln m = 2 atanh((m - 1)/(m + 1)), the series cut at 2e-9.
template <typename Float>
inline Float fast_log(Float x) {
  const auto bits = bits_of(x);
  const auto exponent = (bits - 0x3f3504f3) >> 23;
  const Float m = from_bits(bits - (exponent << 23));
  const Float s = (m - 1.f) / (m + 1.f), s2 = s * s, s4 = s2 * s2;
  const Float series = (1.f + s2 * (1.f / 3)) + s4 * ((1.f / 5 + s2 * (1.f / 7)) + s4 * (1.f / 9));
  return 0.693147181f * to_float(exponent) + 2.f * s * series;
}

template <typename Float>
inline Float fast_log2(Float x) {
  return 1.44269504f * fast_log(x);
}

/// 2^x for x <= 126, relative error below 3e-7 for |x| < 8 (the rounding of x itself beyond); 2^-126 below
/// -126.
template <typename Float>
inline Float fast_exp2(Float x) {
  const Float low = x - x - 126.f;
  x = x < low ? low : x;
  const auto whole = to_integer(x + 126.5f) - 126;  // rounds to nearest: the argument is positive
  const Float y = 0.693147181f * (x - to_float(whole)), y2 = y * y;
  const Float power =
      (1.f + y) + y2 * ((1.f / 2 + y * (1.f / 6)) + y2 * ((1.f / 24 + y * (1.f / 120)) + y2 * (1.f / 720)));
  return power * from_bits((whole + 127) << 23);
}

}  // namespace alabaster
