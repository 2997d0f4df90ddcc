#pragma once
// The inner loop of the planar reference: one photon in a half-space, in optical lengths, z = depth. Private
// to integrators/planar_*.cpp.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/vec.h"
#include "integrators/planar_scene.h"

namespace alabaster {

/// The albedo for C channels: the texture's finest level, bilinear, repeated; in optical lengths of the
/// plane.
template <int C>
class WalkTexture {
 public:
  /// Channels first .. first + C - 1; `mean_free_path` converts optical lengths to metres.
  WalkTexture(const PlanarScene& scene, int first, double mean_free_path)
      : width_(scene.albedo->width), height_(scene.albedo->height) {
    // One row and column more, so that the four neighbours never wrap.
    stride_ = static_cast<std::size_t>(width_ + 1) * C;
    texels_.resize(stride_ * static_cast<std::size_t>(height_ + 1));
    for (int y = 0; y <= height_; ++y)
      for (int x = 0; x <= width_; ++x)
        for (int c = 0; c < C; ++c)
          texels_[static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x * C + c)] =
              scene.albedo->at(x % width_, y % height_)[first + c];
    // Texel centres lie at half-integers of the texture coordinates.
    scale_ = Vec2(mean_free_path * width_ / scene.tile.x, -mean_free_path * height_ / scene.tile.y);
    offset_ = Vec2(0.5 * width_ - 0.5, 0.5 * height_ - 0.5);
  }

  std::array<double, C> at(double x, double y) const {
    const auto [u, i] = split(x * scale_.x + offset_.x, width_);
    const auto [v, j] = split(y * scale_.y + offset_.y, height_);
    const float* top = &texels_[static_cast<std::size_t>(j) * stride_ + static_cast<std::size_t>(i) * C];
    const float* bottom = top + stride_;
    std::array<double, C> result;
    for (int c = 0; c < C; ++c) {
      const double a = top[c] + u * (static_cast<double>(top[c + C]) - top[c]);
      const double b = bottom[c] + u * (static_cast<double>(bottom[c + C]) - bottom[c]);
      result[static_cast<std::size_t>(c)] = a + v * (b - a);
    }
    return result;
  }

 private:
  struct Split {
    double fraction;
    int index;
  };
  static Split split(double t, int size) {
    t -= size * std::floor(t / size);
    const int index = std::min(static_cast<int>(t), size - 1);  // rounding may give t = size
    return {t - index, index};
  }

  int width_, height_;
  std::size_t stride_;
  std::vector<float> texels_;
  Vec2 scale_{0}, offset_{0};
};

}  // namespace alabaster
