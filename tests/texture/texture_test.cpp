#include "texture/texture.h"

#include <catch2/catch.hpp>
#include <limits>

#include "core/rng.h"
#include "image/png_file.h"
#include "image/srgb.h"
#include "texture/texel_array.h"

using namespace alabaster;

namespace {

Texture numbered(int width, int height, TextureMapping mapping) {
  auto texels = std::make_shared<TexelArray>();
  *texels = {width, height, {}};
  for (int i = 0; i < width * height; ++i) texels->texels.emplace_back(float(i), float(2 * i), 0.0f, 1.0f);
  return Texture(texels, mapping);
}

}  // namespace

TEST_CASE("wrap modes index as glTF samplers do") {
  const int expected_repeat[] = {1, 2, 0, 1, 2, 0, 1}, expected_mirror[] = {1, 0, 0, 1, 2, 2, 1};
  for (int i = -2; i <= 4; ++i) {
    CHECK(wrap_index(i, 3, Wrap::repeat) == expected_repeat[i + 2]);
    CHECK(wrap_index(i, 3, Wrap::mirror) == expected_mirror[i + 2]);
    CHECK(wrap_index(i, 3, Wrap::clamp) == std::max(0, std::min(2, i)));
    CHECK(wrap_index(i, 1, Wrap::repeat) == 0);
    CHECK(wrap_index(i, 1, Wrap::mirror) == 0);
  }
  CHECK(wrap_index(std::numeric_limits<int>::min(), 5, Wrap::repeat) >= 0);
}

TEST_CASE("texel centres give the texel, midpoints the mean, v = 0 is the top row") {
  const Texture t = numbered(4, 3, {});
  CHECK(t.evaluate({0.125, 0.5 / 3}).x == Approx(0).margin(1e-12));
  CHECK(t.evaluate({0.375, 2.5 / 3}).x == Approx(9));
  CHECK(t.evaluate({0.25, 0.5}).x == Approx(4.5));
  CHECK(t.evaluate({0.0, 0.5 / 3}).x == Approx(1.5));  // between texels 3 and 0: repeat
  CHECK(t.evaluate({2.125, -2.5 / 3}).x == Approx(t.evaluate({0.125, 0.5 / 3}).x).margin(1e-9));
  TextureMapping nearest;
  nearest.filter = Filter::nearest;
  CHECK(numbered(4, 3, nearest).evaluate({0.49, 0.99}).x == 9);
  CHECK(std::isfinite(t.evaluate({std::nan(""), 1e300}).x));
}

TEST_CASE("KHR_texture_transform: the specification's own example") {
  // "utilizes only the lower left quadrant of the source image, rotated clockwise 90 degrees"
  TextureMapping m;
  m.offset = {0, 1};
  m.rotation = pi / 2;
  m.scale = {0.5, 0.5};
  const Vec2 a = m.transform({0, 0}), b = m.transform({1, 0}), c = m.transform({0, 1});
  CHECK(glm::distance(a, Vec2(0, 1)) < 1e-12);
  CHECK(glm::distance(b, Vec2(0, 0.5)) < 1e-12);
  CHECK(glm::distance(c, Vec2(0.5, 1)) < 1e-12);
  const Mat2 j = m.linear_part();
  CHECK(glm::distance(j * Vec2(1, 0), b - a) < 1e-12);
  CHECK(glm::distance(j * Vec2(0, 1), c - a) < 1e-12);
}

TEST_CASE("colour texels are linearised, data texels are not") {
  Pixels8 pixels(1, 1, 4);
  pixels.bytes = {128, 0, 255, 51};
  const DecodedImage image = decode_image(encode_png(pixels), "t.png");
  CHECK(make_texels(image, Encoding::srgb).at(0, 0) == Vec4f(float(srgb_to_linear(128 / 255.0)), 0, 1, 0.2f));
  CHECK(make_texels(image, Encoding::linear).at(0, 0).x == Approx(128 / 255.0));
}
