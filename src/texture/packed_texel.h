#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/rgb.h"
#include "core/vec.h"

namespace alabaster {

/// An average of albedo and its weight in 8 bytes: three codes between the least and the largest value there
/// is (PackedRange), one for the weight, in a unit of the level's own. Albedo and weight are kept apart: a
/// small weight costs no accuracy of the albedo, and sums stay among the values that were packed.
using PackedTexel = std::array<uint16_t, 4>;

// One texel, and two, that the compiler keeps in one register (GCC and Clang vector extension).
using Float4 = float __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));

inline constexpr float largest_code = 65535;

/// Two neighbours, as codes.
inline Float8 load_pair(const PackedTexel* texels) {
#ifdef __AVX2__  // GCC 12 makes seven instructions of the other form
  return _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(texels))));
#else
  using Code8 = uint16_t __attribute__((vector_size(16)));
  using Int8 = int32_t __attribute__((vector_size(32)));
  Code8 codes;
  std::memcpy(&codes, texels, sizeof codes);
  return __builtin_convertvector(__builtin_convertvector(codes, Int8), Float8);
#endif
}

/// Of two texels' codes (albedo, weight): (albedo * weight, weight), times `factor`.
inline Float8 weighted_pair(Float8 pair, Float8 factor) {
  constexpr Float8 ones = {1, 1, 1, 1, 1, 1, 1, 1};
  return __builtin_shufflevector(pair, ones, 0, 1, 2, 8, 4, 5, 6, 12) *
         (__builtin_shufflevector(pair, pair, 3, 3, 3, 3, 7, 7, 7, 7) * factor);
}

/// The values that codes stand for: low + code * step. Where all are one, it comes out exactly.
class PackedRange {
 public:
  PackedRange() = default;
  PackedRange(const Rgb& low, const Rgb& high) : low_(low), step_((high - low) / double{largest_code}) {
    for (int c = 0; c < 3; ++c) per_step_[c] = step_[c] > 0 ? static_cast<float>(1 / step_[c]) : 0;
  }

  /// Codes of the mean of `sum`, albedo * weight and weight, not rounded; weight > 0.
  Vec3f codes(const Vec4f& sum) const {
    return (Vec3f(sum) / sum.w - Vec3f(low_.r, low_.g, low_.b)) * per_step_;
  }
  /// The value nearest to an albedo of one channel that a code stands for.
  float nearest(float albedo, int channel) const {
    const auto low = static_cast<float>(low_[channel]);
    const float code = std::round((albedo - low) * per_step_[channel]);
    return static_cast<float>(low_[channel] + step_[channel] * static_cast<double>(code));
  }
  PackedTexel pack(const Vec4f& sum, float codes_per_weight) const {
    const float weight = std::round(sum.w * codes_per_weight);
    if (!(weight > 0)) return {};
    PackedTexel texel;
    const Vec3f code = codes(sum);
    for (int c = 0; c < 3; ++c)
      texel[static_cast<std::size_t>(c)] =
          static_cast<uint16_t>(std::clamp(std::round(code[c]), 0.0f, largest_code));
    texel[3] = static_cast<uint16_t>(std::min(weight, largest_code));
    return texel;
  }
  /// The mean albedo of a sum over texels of (codes * weight, weight).
  Rgb mean(const Vec4f& sum) const {
    const float inverse = 1 / sum.w;
    return low_ + step_ * Rgb(sum.x * inverse, sum.y * inverse, sum.z * inverse);
  }
  const Rgb& low() const { return low_; }

 private:
  Rgb low_, step_;
  Vec3f per_step_{0};
};

}  // namespace alabaster
