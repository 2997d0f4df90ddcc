#pragma once

#include <cstdint>
#include <vector>

#include "core/rgb.h"
#include "core/sampler.h"
#include "image/image.h"

namespace alabaster {

/// Sums of samples in double with a count per pixel, and the variance of the mean from the sampler's
/// independent groups. Different pixels may be added to from different threads.
class Film {
 public:
  Film(int width, int height, SamplerKind sampler);

  struct Auxiliary {
    Rgb albedo;
    Vec3 normal{0};
    double depth = 0;
  };
  /// Samples of a pixel must arrive in order of their index, without gaps.
  void add(int x, int y, const Rgb& radiance, double alpha, const Auxiliary* first_hit);
  uint32_t count(int x, int y) const;

  /// R G B A, variance.R/.G/.B (of the mean), samples.Y, albedo.R/.G/.B, normal.X/.Y/.Z, depth.Z
  Image develop() const;
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  struct Pixel;
  int width_, height_;
  SamplerKind sampler_;
  std::vector<Pixel> pixels_;
};

}  // namespace alabaster
