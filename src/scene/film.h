#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/rgb.h"
#include "core/sampler.h"
#include "core/vec.h"
#include "image/image.h"

namespace alabaster {

/// Sums of samples in double with a count per pixel, and the variance of the mean from the sampler's
/// independent groups. Different pixels may be added to from different threads.
///
/// Variance of the mean. The independent sampler's samples are each a group by itself; the Sobol sampler's
/// groups are those of sample_group(). Groups of one size are independent and identically distributed, so the
/// variance of a group's sum is estimated from the finished groups of its size, and the variances of all
/// groups' sums add up. What the finished groups cannot tell is filled in on the safe side: a lone
/// group counts with the variance per sample of the groups next smaller; the samples of an unfinished group,
/// and all samples of a pixel with fewer than two finished groups, with the plain variance of samples (above
/// that of a stratified mean); a single sample with the square of its value.
class Film {
 public:
  Film(int width, int height, SamplerKind sampler);

  /// What the first surface shows, averaged over the samples that hit one.
  struct Auxiliary {
    Rgb albedo;
    Vec3 normal{0};
    double depth = 0;
  };
  /// Samples of a pixel must arrive in order of their index, without gaps. `first_hit` is null for a sample
  /// that hits nothing.
  void add(int x, int y, const Rgb& radiance, double alpha, const Auxiliary* first_hit);
  uint32_t count(int x, int y) const;
  /// All samples of all pixels.
  uint64_t total_count() const;

  /// R G B A, variance.R/.G/.B (of the mean), samples.Y, albedo.R/.G/.B, normal.X/.Y/.Z, depth.Z. Pixels
  /// without a sample are 0 everywhere.
  Image develop() const;
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  struct Channel {
    double sum = 0, group_sum = 0;  // of all samples, and of those of the unfinished group
    double mean = 0;                // of the sums of the finished groups of the current size
    float squares = 0;              // their summed squared deviations (Welford 1962)
    float finished_variance = 0;    // of the sum of all groups of smaller sizes
    float rate = 0;                 // variance per sample, from the groups next smaller
    float early_squares = 0;        // summed squares of the samples of the first two groups
    float plain_variance = 0;       // of one sample, from those
  };
  struct Pixel {
    std::array<Channel, 3> channels;
    double alpha = 0;
    uint32_t count = 0, hits = 0;
    std::array<float, 7> auxiliary{};  // sums
  };
  struct Place;
  Place place(uint32_t sample) const;
  static void add_value(Channel& channel, double value, const Place& place);
  double variance_of_mean(const Channel& channel, uint32_t count) const;
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_, height_;
  SamplerKind sampler_;
  std::vector<Pixel> pixels_;
};

}  // namespace alabaster
