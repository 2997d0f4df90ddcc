#pragma once
// What the pyramids over a texture agree on: their levels and the kernel that reads them. Private to
// src/texture/*_pyramid.cpp.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "texture/texture.h"

namespace alabaster {

// Spacings: level 1 has 2 texels per sample, further ones sqrt(2.5) times more each, so that all of them
// together are 0.42 of the texture. Every sample averages a Gaussian of 0.4 spacings squared, and the kernel
// that reads a level has between 0.4 and 1.6: the alias of the pair is at most exp(-0.4 pi^2) = 1.9 % of a
// sinusoid of the worst frequency.
inline constexpr double first_spacing = 2, spacing_ratio = 1.58113883008419;
inline constexpr double level_blur = 0.4, narrowest_kernel = 0.4, widest_kernel = 3.2;
// Kernels at least this wide are bells; narrower ones, at the finest level only, are its own reconstruction
// blurred.
inline constexpr float narrowest_bell = 1.0f / 3;

// The bell of a kernel of that variance (spacings squared) that falls to exactly 0 at taps / 2, so that the
// result is continuous when the taps move on by one.
struct Bell {
  float scale, pedestal;

  template <class Float>
  static Float power(Float x, Float scale) {
    // (1 - x^2 / (67 v))^32 has variance v and is all but Gaussian (excess kurtosis -0.09).
    Float b = 1 - x * x * scale;
    b = b > 0 ? b : b - b;
    b *= b, b *= b, b *= b, b *= b;
    return b * b;
  }
  template <int taps>
  static Bell of(float variance) {
    constexpr auto reach = static_cast<float>(taps / 2);
    const float nominal = nominal_variance(variance, 8 / (reach * reach));
    const float scale = 1 / (67 * nominal);
    return {scale, power(reach, scale)};
  }
  /// Subtracting the pedestal narrows the bell; this widens it again (a fit, within 0.1 % for t <= 1.05).
  /// `per_reach` is 8 / reach^2, the reach half the taps.
  template <class Float>
  static Float nominal_variance(Float variance, Float per_reach) {
    const Float t = variance * per_reach;
    return variance * (1 + t * t * t * (-0.0867341f + t * (0.1663139f + t * 0.1145253f)));
  }
};

// One sample of a coarser axis as a sum over the finer one.
struct Resampling {
  int first = 0;
  std::vector<float> weights;
};

inline Resampling gaussian_resampling(int from, int to, int j, double variance) {
  if (from == to) return {j, {1.0f}};
  const double centre = (j + 0.5) * from / to - 0.5, reach = 4.6 * std::sqrt(variance);
  Resampling row{static_cast<int>(std::ceil(centre - reach)), {}};
  const int last = static_cast<int>(std::floor(centre + reach));
  const auto gaussian = [&](int i) { return std::exp(-0.5 * (i - centre) * (i - centre) / variance); };
  double sum = 0;
  for (int i = row.first; i <= last; ++i) sum += gaussian(i);
  for (int i = row.first; i <= last; ++i) row.weights.push_back(static_cast<float>(gaussian(i) / sum));
  return row;
}

// The next coarser extent of an axis. It stays when too few samples would be left, or when the step would be
// too small for a Gaussian sampled on the finer grid.
inline int coarser_extent(int finest, int current, double spacing, Wrap wrap) {
  const int least = wrap == Wrap::repeat ? 4 : 2;
  const int next = std::max(least, static_cast<int>(std::ceil(finest / spacing)));
  const bool worth_it = 1.8 * next * next <= static_cast<double>(current) * current;
  return next < current && worth_it ? next : current;
}

// The smallest total variance, in texels of level 0 squared, that a level serves which follows `last`.
template <class Draft>
double served_from(const Draft& level, const Draft& last) {
  double from = 0;
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (level.extent[axis] != last.extent[axis])
      from = std::max(from, (level_blur + narrowest_kernel) /
                                (level.samples_per_texel[axis] * level.samples_per_texel[axis]));
  return from;
}

}  // namespace alabaster
