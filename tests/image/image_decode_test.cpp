#include "image/image_decode.h"

#include <webp/encode.h>

#include <catch2/catch.hpp>

#include "core/error.h"
#include "core/rng.h"
#include "image/exr_file.h"
#include "image/png_file.h"
#include "image/srgb.h"
#include "support/paths.h"

using namespace alabaster;

namespace {

Pixels8 random_pixels(int width, int height, int channels) {
  Pixels8 pixels(width, height, channels);
  Rng rng(1);
  for (uint8_t& byte : pixels.bytes) byte = static_cast<uint8_t>(rng.next() >> 56);
  return pixels;
}

// A 2 x 1 16-bit grey PNG with the codes 0x0102 and 0xfffe, written out by hand.
const std::vector<uint8_t> grey16_png{
    0x89, 'P',  'N',  'G',  0x0d, 0x0a, 0x1a, 0x0a, 0,    0,    0,    13,   'I',  'H',  'D',
    'R',  0,    0,    0,    2,    0,    0,    0,    1,    16,   0,    0,    0,    0,    0,
    0,    0,    0,    0,    0,    0,    16,   'I',  'D',  'A',  'T',  0x78, 0x01, 0x01, 0x05,
    0x00, 0xfa, 0xff, 0x00, 0x01, 0x02, 0xff, 0xfe, 0x05, 0x07, 0x02, 0x01, 0,    0,    0,
    0,    0,    0,    0,    0,    'I',  'E',  'N',  'D',  0,    0,    0,    0};

}  // namespace

TEST_CASE("sRGB follows IEC 61966-2-1") {
  CHECK(srgb_to_linear(0.5) == Approx(0.21404114048223255).epsilon(1e-12));
  CHECK(srgb_to_linear(1) == Approx(1).epsilon(1e-12));
  CHECK(srgb_to_linear(0.04045) == Approx(0.0031308).epsilon(1e-4));  // the two pieces meet
  CHECK(srgb_to_linear(0.02) == Approx(0.02 / 12.92));
  for (int code = 0; code < 256; ++code) CHECK(linear_to_srgb8(srgb_to_linear(code / 255.0)) == code);
  CHECK(linear_to_srgb8(-1) == 0);
  CHECK(linear_to_srgb8(7) == 255);
  CHECK(linear_to_srgb8(std::nan("")) == 0);
}

TEST_CASE("PNG in RGB, RGBA and grey survives writing and decoding") {
  for (const int channels : {1, 3, 4}) {
    Pixels8 pixels = random_pixels(33, 17, channels);
    const DecodedImage image = decode_image(encode_png(pixels), "test.png");
    REQUIRE(image.width == 33);
    REQUIRE(image.height == 17);
    CHECK(image.file_channels == channels);
    const auto& rgba = std::get<std::vector<uint8_t>>(image.rgba);
    for (int y = 0; y < 17; ++y)
      for (int x = 0; x < 33; ++x)
        for (int c = 0; c < 4; ++c) {
          const int expected = c == 3 && channels < 4 ? 255 : pixels.at(x, y)[channels == 1 ? 0 : c];
          REQUIRE(rgba[static_cast<std::size_t>((y * 33 + x) * 4 + c)] == expected);
        }
  }
}

TEST_CASE("16-bit PNG keeps its precision") {
  const DecodedImage image = decode_image(grey16_png, "grey16.png");
  REQUIRE(image.width == 2);
  const auto& rgba = std::get<std::vector<uint16_t>>(image.rgba);
  CHECK(rgba == std::vector<uint16_t>{0x0102, 0x0102, 0x0102, 0xffff, 0xfffe, 0xfffe, 0xfffe, 0xffff});
}

TEST_CASE("lossless WebP decodes exactly, EXR in float") {
  Pixels8 pixels = random_pixels(20, 9, 4);
  for (std::size_t i = 3; i < pixels.bytes.size(); i += 4)
    pixels.bytes[i] |= 1;  // colour under alpha 0 is free
  uint8_t* file = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(pixels.bytes.data(), 20, 9, 80, &file);
  REQUIRE(size > 0);
  const DecodedImage image = decode_image({file, size}, "test.webp");
  CHECK(std::get<std::vector<uint8_t>>(image.rgba) == pixels.bytes);
  CHECK_THROWS_AS(decode_image({file, size / 2}, "half.webp"), InputError);
  WebPFree(file);

  const ScratchFolder folder;
  Image exr(2, 1, {"R", "G", "B"});
  exr.set_rgb(0, 1, 0, {0.999991, 3, -1});
  write_exr(folder / "t.exr", exr);
  const DecodedImage decoded = read_image(folder / "t.exr");
  REQUIRE(decoded.is_float());
  CHECK(std::get<std::vector<float>>(decoded.rgba) == std::vector<float>{0, 0, 0, 1, 0.999991f, 3, -1, 1});
}

TEST_CASE("damaged or foreign pictures are refused by name") {
  CHECK_THROWS_WITH(decode_image(std::vector<uint8_t>{'G', 'I', 'F', '8'}, "x.gif"),
                    Catch::Contains("x.gif") && Catch::Contains("PNG"));
  CHECK_THROWS_AS(decode_image({}, "empty.png"), InputError);
  const std::vector<uint8_t> png = encode_png(random_pixels(64, 64, 3));
  CHECK_THROWS_AS(decode_image(std::span(png).subspan(0, png.size() / 2), "cut.png"), InputError);
  CHECK_THROWS_AS(decode_image(std::vector<uint8_t>{0xff, 0xd8, 0xff, 0xe0, 1, 2}, "cut.jpg"), InputError);
}

TEST_CASE("display pixels: exposure in stops, premultiplied alpha divided out, NaN black") {
  Image image(3, 1, {"R", "G", "B", "A"});
  image.set_rgb(0, 0, 0, {0.1, 0.2, 0.05});
  image.at(3, 0, 0) = 0.5f;
  image.set_rgb(0, 1, 0, {std::nan(""), 9, 0});
  image.at(3, 1, 0) = 1;
  Pixels8 pixels = display_pixels(image, 1);
  REQUIRE(pixels.channels == 4);
  CHECK(pixels.at(0, 0)[0] == linear_to_srgb8(0.4));
  CHECK(pixels.at(0, 0)[1] == linear_to_srgb8(0.8));
  CHECK(pixels.at(0, 0)[3] == 128);
  CHECK(pixels.at(1, 0)[0] == 0);
  CHECK(pixels.at(1, 0)[1] == 255);
  CHECK(pixels.at(2, 0)[3] == 0);
  Image opaque(1, 1, {"R", "G", "B", "A"});
  opaque.at(3, 0, 0) = 1;
  CHECK(display_pixels(opaque).channels == 3);
}
