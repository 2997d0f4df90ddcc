#pragma once

#include <memory>
#include <vector>

#include "texture/packed_texel.h"
#include "texture/texture.h"

namespace alabaster {

/// A texture and its Gaussian-filtered, ever coarser versions, each texel weighted by how much of it the
/// surface covers: no texel outside a chart is ever averaged. Level 0 is the texture itself. Held in 16 bits
/// a channel between the least and the largest covered value: off by at most 8e-6 of that range.
///
/// A lookup reads one level only, through a kernel of 4 x 4 to 10 x 10 taps whose width makes up for what the
/// level's own blur lacks; results lie in the convex hull of the covered texels, and a constant texture comes
/// out constant up to float rounding. What lies beyond the edge: repeat and mirror continue exactly; with
/// clamp it is not surface and counts for nothing. docs/pyramids.md has accuracy and cost. Thread-safe.
class GaussianPyramid {
 public:
  /// `coverage` has one weight per texel, 0 to 1 (empty: all 1). Texels of zero weight never contribute; when
  /// all are zero the coverage is taken as 1. `filter` is how the finest level is read.
  GaussianPyramid(const TexelArray& texels, std::vector<float> coverage, Wrap wrap_u, Wrap wrap_v,
                  Filter filter = Filter::linear);

  /// Bilinear (or nearest) at the finest level, weighted by coverage. `st` in texture space (after the
  /// mapping's transform). Where no texel near st is covered: the closest coarser average that exists.
  Rgb at(Vec2 st) const;
  /// The average of at() under a Gaussian of standard deviation `sigma` texels (of level 0). From about half
  /// the texture on (its whole, where it is mirrored or clamped) it runs into mean().
  Rgb filtered(Vec2 st, double sigma_texels) const;
  /// Gaussian with covariance in texels; several taps along the long axis when it is stretched, at most 17:
  /// beyond a ratio of about 6 the short axis is blurred as well.
  Rgb filtered(Vec2 st, const Mat2& covariance_texels) const;

  /// Largest and coverage-weighted mean value over covered texels.
  Rgb max() const { return max_; }
  Rgb mean() const;
  int width() const { return levels_.front().extent[0]; }
  int height() const { return levels_.front().extent[1]; }
  std::size_t memory_bytes() const;

 private:
  template <class Texel>
  struct Samples {
    int extent[2] = {0, 0};         // samples along u and v
    double samples_per_texel[2]{};  // extent over level 0's
    double blur[2]{};               // variance of what a sample averages, in its own spacings squared
    std::size_t stride = 0;         // padded row
    std::vector<Texel> texels;      // with a margin that continues the wrap

    const Texel* sample(int x, int y) const { return texels.data() + index(x, y); }
    Texel* sample(int x, int y) { return texels.data() + index(x, y); }

    std::size_t index(int x, int y) const;
  };
  using Draft = Samples<Vec4f>;  // rgb * weight, weight
  struct Level : Samples<PackedTexel> {
    float weight_unit = 1;  // of a code
    /// By tile: whether all weights are the largest that a kernel may meet whose first tap lies in it, so
    /// that it need not read them.
    std::vector<uint8_t> full;
    std::size_t tiles_per_row = 0;

    bool is_full(int x, int y) const;
  };
  static Draft allocate(int width, int height);
  void fill_margin(Draft& level) const;
  Draft coarser(const Draft& level, int width, int height) const;
  void add(const Draft& level);
  static void find_full_tiles(Level& level);
  void add_coarser_levels(Draft finest);

  Vec4f gather(Vec2 st, double variance) const;
  Vec4f gather_along(Vec2 st, Vec2 axis, double narrow, double extra) const;
  Rgb resolve(Vec2 st, double variance, const Vec4f& sum) const;

  std::vector<Level> levels_;
  std::vector<double> level_from_;  // smallest total variance served by level 1, 2, ...; texels of level 0
  Wrap wrap_[2];
  Filter filter_;
  double mean_from_ = 0;  // total variance from which the mean is blended in
  PackedRange range_;
  Vec4f mean_{0};  // codes * weight, weight
  Rgb max_;
};

}  // namespace alabaster
