#pragma once

#include "core/rgb.h"
#include "core/sampler.h"
#include "core/vec.h"

namespace alabaster {

/// One sample of a pixel, with the first surface's data for the auxiliary channels.
struct PixelSample {
  Rgb radiance;
  double alpha = 0;  // 1 where an object (or a visible environment) covers the pixel
  Rgb albedo;
  Vec3 normal{0};
  double depth = 0;  // m along the camera's direction
  bool hit = false;  // the three above are valid
};

/// Radiance through a point of the image. Thread-safe; all randomness comes from the sampler.
class Integrator {
 public:
  virtual ~Integrator() = default;
  /// `pixel` is the integer pixel; the sampler was started for it and for this sample.
  virtual PixelSample sample(int x, int y, const Sampler& sampler) const = 0;
  virtual int width() const = 0;
  virtual int height() const = 0;
};

}  // namespace alabaster
