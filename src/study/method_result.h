#pragma once

#include <cstdint>
#include <string>

#include "image/image.h"
#include "image/metrics.h"

namespace alabaster {

/// An image with what it cost.
struct TimedImage {
  Image image;  // R G B A, variance.R/.G/.B, samples.Y at least
  double seconds = 0, cpu_seconds = 0;
  uint64_t samples = 0;  // of all pixels; paths for the flat reference
};

/// One method on one scene, compared with the reference.
struct MethodResult {
  std::string model;
  TimedImage render;
  Metrics errors;
};

/// sqrt(mean variance / mean square) over pixels and channels: the noise of one image alone.
double noise_of(const Image& image);

}  // namespace alabaster
