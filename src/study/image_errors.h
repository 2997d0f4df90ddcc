#pragma once

#include "image/image.h"

namespace alabaster {

/// The measures of an image against a reference (docs/architecture.md), with 95 % intervals from the images'
/// own variance channels.
struct ImageErrors {
  double rmse_over_rms = 0;
  double bias =
      0;  // the same without either image's noise; negative when the noise explains more than all of it
  double noise = 0;               // of both images together
  double mean_bias = 0;           // mean(a) / mean(b) - 1
  double mean_abs_log_ratio = 0;  // capped at ln 1000
  double kept = 0;  // share of the pixels above 1e-4 of the maximum that the log ratio could use
  double bias_interval = 0, mean_bias_interval = 0, log_interval = 0;  // half-widths, 95 %
};

/// Both images need R, G, B and variance.R, .G, .B and one size.
ImageErrors image_errors(const Image& a, const Image& reference);

}  // namespace alabaster
