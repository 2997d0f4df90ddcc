#pragma once

#include <memory>
#include <vector>

#include "texture/texture.h"

namespace alabaster {

/// A texture and its Gaussian-filtered, ever coarser versions, each texel weighted by how much of it the
/// surface covers: no texel outside a chart is ever averaged. Level 0 is the texture itself.
class GaussianPyramid {
 public:
  /// `coverage` has one weight per texel, 0 to 1 (empty: all 1). Texels of zero weight never contribute.
  GaussianPyramid(const TexelArray& texels, std::vector<float> coverage, Wrap wrap_u, Wrap wrap_v);

  /// Bilinear at the finest level, weighted by coverage. `st` in texture space (after the mapping's
  /// transform).
  Rgb at(Vec2 st) const;
  /// The average under a Gaussian of standard deviation `sigma` texels (of level 0), by one trilinear lookup.
  Rgb filtered(Vec2 st, double sigma_texels) const;
  /// Gaussian with covariance in texels; several taps along the long axis when it is stretched.
  Rgb filtered(Vec2 st, const Mat2& covariance_texels) const;

  Rgb max() const { return max_; }
  int width() const;
  int height() const;
  std::size_t memory_bytes() const;

 private:
  struct Level {
    int width = 0, height = 0;
    double sigma = 0;           // total blur of this level, level-0 texels
    std::vector<Vec4f> texels;  // rgb * weight, weight
  };
  Vec4 lookup(const Level& level, Vec2 st) const;
  std::vector<Level> levels_;
  Wrap wrap_u_, wrap_v_;
  Rgb max_;
};

}  // namespace alabaster
