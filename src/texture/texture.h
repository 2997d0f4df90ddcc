#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/rgb.h"
#include "core/vec.h"

namespace alabaster {

enum class Wrap { repeat, mirror, clamp };
enum class Filter { nearest, linear };

/// Texels in float, linear RGBA, row 0 at the top (glTF: v = 0 is the top edge).
struct TexelArray {
  int width = 0, height = 0;
  std::vector<Vec4f> texels;

  const Vec4f& at(int x, int y) const {
    return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  Vec4f& at(int x, int y) {
    return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

/// How UVs become texels: the sampler of glTF and KHR_texture_transform.
struct TextureMapping {
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  Filter filter = Filter::linear;
  std::size_t uv_set = 0;
  Vec2 offset{0}, scale{1};
  double rotation = 0;  // radians, counter-clockwise as KHR_texture_transform defines it

  Vec2 transform(Vec2 uv) const;
  Mat2 linear_part() const;
};

/// Texel index of `i` under a wrap mode, for a side of `size`.
int wrap_index(int i, int size, Wrap wrap);

/// An image with its mapping; texels may be shared between textures. Immutable.
class Texture {
 public:
  Texture(std::shared_ptr<const TexelArray> texels, TextureMapping mapping);
  /// Bilinear or nearest value at a raw UV of the mesh (the transform is applied here).
  Vec4 evaluate(Vec2 uv) const;
  const TexelArray& texels() const { return *texels_; }
  const std::shared_ptr<const TexelArray>& shared_texels() const { return texels_; }
  const TextureMapping& mapping() const { return mapping_; }

 private:
  std::shared_ptr<const TexelArray> texels_;
  TextureMapping mapping_;
  Mat2 st_from_uv_;  // linear part of the mapping's transform
};

}  // namespace alabaster
