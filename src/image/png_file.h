#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "image/image.h"

namespace alabaster {

/// 8-bit pixels as PNG stores them: interleaved, row 0 at the top, sRGB, straight (not premultiplied) alpha.
struct Pixels8 {
  int width = 0, height = 0;
  int channels = 3;  // 1 grey, 3 RGB, 4 RGBA
  std::vector<uint8_t> bytes;

  Pixels8() = default;
  Pixels8(int w, int h, int c)
      : width(w),
        height(h),
        channels(c),
        bytes(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(c)) {}
  uint8_t* at(int x, int y) {
    return bytes.data() +
           (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
               static_cast<std::size_t>(channels);
  }
};

/// The picture in an image, times 2^exposure, sRGB encoded and clamped. RGBA when it has an alpha channel
/// that is not 1 everywhere; alpha in an EXR is premultiplied and is divided out here. NaN shows as black.
/// Throws InputError when the image has no colour.
Pixels8 display_pixels(const Image& image, double exposure_stops = 0);
Pixels8 display_pixels(const Image& image, const ColourChannels& colour, double exposure_stops = 0);

std::vector<uint8_t> encode_png(const Pixels8& pixels);
/// Atomic. Throws InputError when the file cannot be written.
void write_png(const std::filesystem::path& path, const Pixels8& pixels);

}  // namespace alabaster
