#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace alabaster {

/// A picture file as it was stored: RGBA, interleaved, row 0 at the top. Grey files have R = G = B, files
/// without alpha are opaque. Integer samples are in the file's encoding (sRGB or data, which only the user of
/// the picture knows); float samples (EXR, HDR) are linear.
struct DecodedImage {
  int width = 0, height = 0;
  int file_channels = 0;  // 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA
  std::variant<std::vector<uint8_t>, std::vector<uint16_t>, std::vector<float>> rgba;

  bool is_float() const { return rgba.index() == 2; }
};

/// Decodes PNG (8 and 16 bit), JPEG, WebP, EXR and Radiance HDR, told apart by their content; `name` is used
/// in messages. Colour profiles and gamma chunks are ignored, as glTF demands. Throws InputError.
DecodedImage decode_image(std::span<const uint8_t> bytes, const std::string& name);
DecodedImage read_image(const std::filesystem::path& path);

}  // namespace alabaster
