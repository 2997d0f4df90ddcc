#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "texture/gaussian_pyramid.h"

namespace alabaster {

/// The isotropic averages of GaussianPyramid, several at once, for a texture that repeats both ways and is
/// surface everywhere, as those of flat scenes are. Levels, kernels and values (rounded to the
/// same 16 bits, but held as floats) are the same, but a level holds a plane per channel (a single one where
/// the texture is grey) and no weights, so that the eight taps of a row are one register; and what the
/// kernels' shapes take, four Gaussians take together. Thread-safe.
class PlanePyramid {
 public:
  explicit PlanePyramid(const TexelArray& texels);

  struct Gaussian {
    Vec2 st{0};        // of the mean, texture space
    double sigma = 0;  // texels
    double weight = 1;
  };
  static constexpr std::size_t most_at_once = 4;
  /// Sum of the averages under up to four Gaussians, each times its weight. Those whose kernel has not four
  /// to eight taps (below about half a texel, around 1.5 texels, above about a quarter of the texture) are
  /// asked of `otherwise`, the pyramid of the same texture.
  Rgb sum(std::span<const Gaussian> gaussians, const GaussianPyramid& otherwise) const;

 private:
  struct Draft;
  static void fill_margin(Draft& draft);
  static Draft coarser(const Draft& finer, int width, int height);
  void add(const Draft& draft);

  struct Level {
    double extent[2];                      // samples along u and v
    double square_of_samples[2];           // per texel of level 0, squared
    double blur[2];                        // variance of what a sample averages, in its own spacings squared
    std::ptrdiff_t stride, plane, origin;  // in samples_: of a row, of a channel, where (0, 0) is
  };
  static constexpr std::size_t most_levels = 16;
  std::size_t channels_;
  PackedRange range_;
  std::vector<float> samples_;
  std::vector<Level> levels_;
  std::array<double, most_levels> level_from_;  // smallest total variance served by level 1, 2, ...
};

}  // namespace alabaster
