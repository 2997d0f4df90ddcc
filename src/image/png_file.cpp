#include "image/png_file.h"

#include <stb_image_write.h>

#include <cassert>
#include <cmath>
#include <string_view>

#include "core/atomic_file.h"
#include "core/error.h"
#include "image/srgb.h"

namespace alabaster {

namespace {

bool is_opaque(const Image& image, int alpha) {
  if (alpha < 0) return true;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (image.at(alpha, x, y) != 1.0f) return false;
  return true;
}

}  // namespace

Pixels8 display_pixels(const Image& image, const ColourChannels& colour, double exposure_stops) {
  const bool opaque = is_opaque(image, colour.alpha);
  const double gain = std::exp2(exposure_stops);
  Pixels8 pixels(image.width(), image.height(), opaque ? 3 : 4);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const double alpha = opaque ? 1 : image.at(colour.alpha, x, y);
      const Rgb shown = colour.get(image, x, y) * (alpha > 0 ? gain / alpha : gain);
      uint8_t* out = pixels.at(x, y);
      for (int c = 0; c < 3; ++c) out[c] = linear_to_srgb8(shown[c]);
      if (!opaque) out[3] = static_cast<uint8_t>(std::lround(255 * (alpha > 0 ? std::min(alpha, 1.0) : 0.0)));
    }
  return pixels;
}

Pixels8 display_pixels(const Image& image, double exposure_stops) {
  const auto colour = find_colour(image);
  if (!colour) throw InputError("the image has no channels R, G and B to show");
  return display_pixels(image, *colour, exposure_stops);
}

std::vector<uint8_t> encode_png(const Pixels8& pixels) {
  assert(pixels.width > 0 && pixels.height > 0);
  std::vector<uint8_t> file;
  const auto append = [](void* context, void* data, int size) {
    const auto* bytes = static_cast<const uint8_t*>(data);
    static_cast<std::vector<uint8_t>*>(context)->insert(static_cast<std::vector<uint8_t>*>(context)->end(),
                                                        bytes, bytes + size);
  };
  if (stbi_write_png_to_func(append, &file, pixels.width, pixels.height, pixels.channels, pixels.bytes.data(),
                             pixels.width * pixels.channels) == 0)
    throw std::bad_alloc();
  return file;
}

void write_png(const std::filesystem::path& path, const Pixels8& pixels) {
  const std::vector<uint8_t> file = encode_png(pixels);
  write_text_atomically(path, std::string_view(reinterpret_cast<const char*>(file.data()), file.size()));
}

}  // namespace alabaster
