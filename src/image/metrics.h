#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "image/image.h"

namespace alabaster {

/// How far picture a is from the reference b, over all pixels and the three channels that are compared
/// (docs/image_and_compare.md has the formulas). Ratios are to the reference's root mean square or mean.
struct Metrics {
  double rmse_over_rms = 0;   // sqrt(mean (a - b)^2 / mean b^2): model error and noise together
  double rmse_over_mean = 0;  // sqrt(mean (a - b)^2) / mean b; over sqrt 2 for two seeds: the noise of either
  /// sign(x) sqrt|x|, x = mean((a - b)^2 - var_a - var_b) / mean b^2: the error without the noise. Nothing
  /// when a variance is missing.
  std::optional<double> bias;
  std::optional<double> noise;  // sqrt(mean(var_a + var_b) / mean b^2)
  double mean_bias = 0;         // mean(a) / mean(b) - 1
  /// mean |ln(a / b)|, capped at ln 1000, where b exceeds ten of its own standard errors (where it is
  /// positive, when b has no variance). Not to be used when kept < 0.95.
  double mean_abs_log_ratio = 0;
  /// Half-widths of 95 % intervals of bias, mean_bias and mean_abs_log_ratio. Nothing when a variance is
  /// missing.
  std::optional<double> bias_interval, mean_bias_interval, log_interval;
  double kept = 0;     // of the values above 1e-4 of the largest: the share used above
  double rel_mse = 0;  // mean((a - b)^2 / (b^2 + 0.01 mean(b)^2))
  double mean_a = 0, mean_b = 0;
  std::size_t pixels = 0;  // compared: inside the mask and finite in both
  bool finite = true;      // no NaN or infinity inside the mask
  double scale = 1;        // what a was multiplied with first
};

struct CompareOptions {
  std::vector<bool> mask;  // one per pixel, empty: all
  bool fit_scale = false;  // multiply a by the factor that brings it closest to b (least squares)
};

/// What is compared: the colour that find_colour() finds, and its variance where there are channels
/// variance.R/.G/.B beside it. Throws InputError when there is no colour, sizes differ, or nothing is left to
/// compare. Names are used in messages.
Metrics compare_images(const Image& a, const Image& b, const CompareOptions& options = {},
                       const std::string& name_a = "A", const std::string& name_b = "B");

/// Whether a picture carries the variance of its colour.
bool has_variance(const Image& image);

}  // namespace alabaster
