#include "texture/texture.h"

#include <cassert>
#include <cmath>

namespace alabaster {

namespace {

// Texel index of a coordinate in texels; coordinates too large for an int (or NaN) land on texel 0.
int floor_to_int(double x) {
  return std::abs(x) < 1e9 ? static_cast<int>(std::floor(x)) : 0;
}

Vec4 texel(const TexelArray& texels, const TextureMapping& m, int x, int y) {
  return Vec4(texels.at(wrap_index(x, texels.width, m.wrap_u), wrap_index(y, texels.height, m.wrap_v)));
}

}  // namespace

Mat2 TextureMapping::linear_part() const {
  const double c = std::cos(rotation), s = std::sin(rotation);
  // Counter-clockwise to the eye, on an image whose v runs downwards: (1, 0) turns towards -v.
  return {Vec2(c, -s) * scale.x, Vec2(s, c) * scale.y};
}

Vec2 TextureMapping::transform(Vec2 uv) const {
  return offset + linear_part() * uv;
}

int wrap_index(int i, int size, Wrap wrap) {
  assert(size > 0);
  if (i >= 0 && i < size) return i;
  switch (wrap) {
    case Wrap::clamp:
      return i < 0 ? 0 : size - 1;
    case Wrap::repeat: {
      const int m = i % size;
      return m < 0 ? m + size : m;
    }
    case Wrap::mirror: {
      const int period = 2 * size;
      int m = i % period;
      if (m < 0) m += period;
      return m < size ? m : period - 1 - m;
    }
  }
  return 0;
}

Texture::Texture(std::shared_ptr<const TexelArray> texels, TextureMapping mapping)
    : texels_(std::move(texels)), mapping_(mapping), st_from_uv_(mapping.linear_part()) {
  assert(texels_ && texels_->width > 0 && texels_->height > 0);
}

Vec4 Texture::evaluate(Vec2 uv) const {
  const Vec2 st = (mapping_.offset + st_from_uv_ * uv) * Vec2(texels_->width, texels_->height);
  if (mapping_.filter == Filter::nearest)
    return texel(*texels_, mapping_, floor_to_int(st.x), floor_to_int(st.y));
  const int x = floor_to_int(st.x - 0.5), y = floor_to_int(st.y - 0.5);
  const double fx = st.x - 0.5 - x, fy = st.y - 0.5 - y;
  if (!(fx >= 0 && fx <= 1 && fy >= 0 && fy <= 1)) return texel(*texels_, mapping_, x, y);
  return (1 - fy) * ((1 - fx) * texel(*texels_, mapping_, x, y) + fx * texel(*texels_, mapping_, x + 1, y)) +
         fy * ((1 - fx) * texel(*texels_, mapping_, x, y + 1) + fx * texel(*texels_, mapping_, x + 1, y + 1));
}

}  // namespace alabaster
