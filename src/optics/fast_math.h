#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

// Single-precision logarithm and exponential without branches or tables, for one number, four or eight at
// once. Only exactly rounded operations: the same result on every machine.

namespace alabaster {

/// Four lanes and eight (vector extension of GCC and Clang; any CPU).
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));
using Int8 = int32_t __attribute__((vector_size(32)));
using Double4 = double __attribute__((vector_size(32)));

inline int32_t to_integer(float x) {
  return static_cast<int32_t>(x);
}
inline Int4 to_integer(Float4 x) {
  return __builtin_convertvector(x, Int4);
}
inline Int8 to_integer(Float8 x) {
  return __builtin_convertvector(x, Int8);
}
inline float to_float(int32_t i) {
  return static_cast<float>(i);
}
inline Float4 to_float(Int4 i) {
  return __builtin_convertvector(i, Float4);
}
inline Float8 to_float(Int8 i) {
  return __builtin_convertvector(i, Float8);
}
inline Float4 to_float(Double4 x) {
  return __builtin_convertvector(x, Float4);
}
inline int32_t bits_of(float x) {
  return std::bit_cast<int32_t>(x);
}
inline Int4 bits_of(Float4 x) {
  return reinterpret_cast<Int4>(x);
}
inline Int8 bits_of(Float8 x) {
  return reinterpret_cast<Int8>(x);
}
inline float from_bits(int32_t i) {
  return std::bit_cast<float>(i);
}
inline Float4 from_bits(Int4 i) {
  return reinterpret_cast<Float4>(i);
}
inline Float8 from_bits(Int8 i) {
  return reinterpret_cast<Float8>(i);
}
/// Eight lanes of twice four, and back.
inline Float8 join(Float4 low, Float4 high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
inline Int8 join(Int4 low, Int4 high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
inline Float4 lower(Float8 x) {
  return __builtin_shufflevector(x, x, 0, 1, 2, 3);
}
inline Float4 upper(Float8 x) {
  return __builtin_shufflevector(x, x, 4, 5, 6, 7);
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
/// Two numbers from one place and two from another.
inline Float4 load2(const float* low, const float* high) {
#ifdef __SSE__
  const auto pair = [](const float* from) { return reinterpret_cast<const __m64*>(from); };
  return _mm_loadh_pi(_mm_loadl_pi(_mm_setzero_ps(), pair(low)), pair(high));
#else
  return Float4{low[0], low[1], high[0], high[1]};
#endif
}
/// Rows become columns: of three rows, four columns whose last lanes repeat the third row's.
inline void columns(Float4 a, Float4 b, Float4 c, Float4 (&column)[4]) {
  const Float4 low = __builtin_shufflevector(a, b, 0, 4, 1, 5),
               high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  column[0] = __builtin_shufflevector(low, c, 0, 1, 4, 4);
  column[1] = __builtin_shufflevector(low, c, 2, 3, 5, 5);
  column[2] = __builtin_shufflevector(high, c, 0, 1, 6, 6);
  column[3] = __builtin_shufflevector(high, c, 2, 3, 7, 7);
}
/// The same in both halves.
inline void columns(Float8 a, Float8 b, Float8 c, Float8 (&column)[4]) {
  const Float8 low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13),
               high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  column[0] = __builtin_shufflevector(low, c, 0, 1, 8, 8, 4, 5, 12, 12);
  column[1] = __builtin_shufflevector(low, c, 2, 3, 9, 9, 6, 7, 13, 13);
  column[2] = __builtin_shufflevector(high, c, 0, 1, 10, 10, 4, 5, 14, 14);
  column[3] = __builtin_shufflevector(high, c, 2, 3, 11, 11, 6, 7, 15, 15);
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
