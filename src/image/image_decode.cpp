#include "image/image_decode.h"

#include <stb_image.h>
#include <webp/decode.h>

#include <cstring>
#include <limits>
#include <memory>

#include "core/atomic_file.h"
#include "core/error.h"
#include "image/exr_file.h"

namespace alabaster {

namespace {

constexpr int64_t max_pixels = int64_t{1} << 29;

bool starts_with(std::span<const uint8_t> bytes, std::string_view magic, std::size_t at = 0) {
  return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
}

void check_size(int64_t width, int64_t height, const std::string& name) {
  if (width < 1 || height < 1 || width * height > max_pixels)
    throw InputError(name, "has " + std::to_string(width) + " x " + std::to_string(height) +
                               " pixels; at most 2^29 are accepted");
}

std::string decoding_failure() {
  const std::string reason = stbi_failure_reason();  // sometimes empty
  return "cannot be decoded" + (reason.empty() ? "" : " (" + reason + ")") + "; the file may be damaged";
}

template <class Sample>
std::vector<Sample> take(Sample* samples, const DecodedImage& image, const std::string& name) {
  const std::unique_ptr<Sample, void (*)(void*)> owner(samples, stbi_image_free);
  if (samples == nullptr) throw InputError(name, decoding_failure());
  const auto count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4;
  return std::vector<Sample>(samples, samples + count);
}

DecodedImage decode_with_stb(std::span<const uint8_t> bytes, const std::string& name) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw InputError(name, "is larger than 2 GB");
  const auto* data = bytes.data();
  const int size = static_cast<int>(bytes.size());
  DecodedImage image;
  int& w = image.width;
  int& h = image.height;
  int& channels = image.file_channels;
  if (stbi_info_from_memory(data, size, &w, &h, &channels) == 0) throw InputError(name, decoding_failure());
  check_size(w, h, name);
  int ignored = 0;
  if (stbi_is_hdr_from_memory(data, size) != 0)
    image.rgba = take(stbi_loadf_from_memory(data, size, &w, &h, &ignored, 4), image, name);
  else if (stbi_is_16_bit_from_memory(data, size) != 0)
    image.rgba = take(stbi_load_16_from_memory(data, size, &w, &h, &ignored, 4), image, name);
  else
    image.rgba = take(stbi_load_from_memory(data, size, &w, &h, &ignored, 4), image, name);
  return image;
}

DecodedImage decode_webp(std::span<const uint8_t> bytes, const std::string& name) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK)
    throw InputError(name, "cannot be decoded as WebP; the file may be damaged");
  if (features.has_animation != 0) throw InputError(name, "is an animated WebP; save one frame of it");
  check_size(features.width, features.height, name);
  DecodedImage image{features.width, features.height, features.has_alpha != 0 ? 4 : 3, {}};
  std::vector<uint8_t> rgba(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                            4);
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), rgba.data(), rgba.size(), image.width * 4) == nullptr)
    throw InputError(name, "cannot be decoded as WebP; the file may be damaged");
  image.rgba = std::move(rgba);
  return image;
}

DecodedImage from_exr(const Image& source, const std::string& name) {
  const auto colour = find_colour(source);
  if (!colour)
    throw InputError(name, "has no channels R, G and B; it has " +
                               (source.channels().empty() ? "none" : source.channels().front() + " ..."));
  check_size(source.width(), source.height(), name);
  DecodedImage image{source.width(), source.height(), colour->alpha >= 0 ? 4 : 3, {}};
  std::vector<float> rgba;
  rgba.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      for (const int channel : colour->rgb) rgba.push_back(source.at(channel, x, y));
      rgba.push_back(colour->alpha >= 0 ? source.at(colour->alpha, x, y) : 1.0f);
    }
  image.rgba = std::move(rgba);
  return image;
}

}  // namespace

DecodedImage decode_image(std::span<const uint8_t> bytes, const std::string& name) {
  if (starts_with(bytes, "RIFF") && starts_with(bytes, "WEBP", 8)) return decode_webp(bytes, name);
  if (starts_with(bytes, "\x76\x2f\x31\x01")) return from_exr(decode_exr(bytes, name).image, name);
  if (starts_with(bytes, "\x89PNG") || starts_with(bytes, "\xff\xd8\xff") ||
      starts_with(bytes, "#?RADIANCE") || starts_with(bytes, "#?RGBE"))
    return decode_with_stb(bytes, name);
  throw InputError(name, "is not a PNG, JPEG, WebP, EXR or HDR picture; convert it to one of these");
}

DecodedImage read_image(const std::filesystem::path& path) {
  const std::string bytes = read_text(path);
  return decode_image({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()}, path.string());
}

}  // namespace alabaster
