#pragma once

#include <span>
#include <string>
#include <vector>

#include "image/image.h"
#include "image/png_file.h"

namespace alabaster {

/// Linear colour of a sequential map, t in [0, 1] (clamped): dark violet through green to pale yellow, equal
/// steps of t being equal steps of lightness (Oklab), so that it also reads in grey.
Rgb sequential_colour(double t);
/// Linear colour of a diverging map, t in [-1, 1] (clamped): blue, near-white at 0, red; both sides equally
/// light.
Rgb diverging_colour(double t);

/// How numbers become colours. Signed: -high .. high through the diverging map. Logarithmic: decades from low
/// to high (signed: from low up on either side, smaller magnitudes are the neutral colour).
struct ColourScale {
  double low = 0, high = 1;
  bool is_signed = false;
  bool logarithmic = false;

  /// Linear colour of a value; NaN shows as magenta.
  Rgb colour(double value) const;
  /// The place of a value on the map: [0, 1], or [-1, 1] when signed.
  double position(double value) const;
  double value_at(double position) const;
};

/// A scale whose ends are that percentile of |values| (finite ones); never empty.
ColourScale fitted_scale(std::span<const float> values, bool is_signed, double percentile = 99);

Pixels8 false_colour(std::span<const float> values, int width, int height, const ColourScale& scale);
/// The picture with a colour bar and its numbers below it (RGB).
Pixels8 with_legend(const Pixels8& picture, const ColourScale& scale);

/// Mean over R, G, B of a - b, per pixel. Sizes must agree.
std::vector<float> signed_difference(const Image& a, const ColourChannels& colour_a, const Image& b,
                                     const ColourChannels& colour_b);

}  // namespace alabaster
