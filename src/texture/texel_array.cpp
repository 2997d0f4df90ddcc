#include "texture/texel_array.h"

#include <limits>

#include "image/srgb.h"

namespace alabaster {

namespace {

// The linear value of every code of an integer sample.
template <class Sample>
std::vector<float> decoding_table(Encoding encoding) {
  constexpr int codes = std::numeric_limits<Sample>::max() + 1;
  std::vector<float> table(codes);
  for (int code = 0; code < codes; ++code) {
    const double value = static_cast<double>(code) / (codes - 1);
    table[static_cast<std::size_t>(code)] =
        static_cast<float>(encoding == Encoding::srgb ? srgb_to_linear(value) : value);
  }
  return table;
}

template <class Sample>
void decode(const std::vector<Sample>& rgba, Encoding encoding, std::vector<Vec4f>& texels) {
  const auto colour = decoding_table<Sample>(encoding), alpha = decoding_table<Sample>(Encoding::linear);
  for (std::size_t i = 0; i < texels.size(); ++i)
    texels[i] = {colour[rgba[4 * i]], colour[rgba[4 * i + 1]], colour[rgba[4 * i + 2]],
                 alpha[rgba[4 * i + 3]]};
}

void decode(const std::vector<float>& rgba, Encoding, std::vector<Vec4f>& texels) {
  for (std::size_t i = 0; i < texels.size(); ++i)
    texels[i] = {rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2], rgba[4 * i + 3]};
}

}  // namespace

TexelArray make_texels(const DecodedImage& image, Encoding encoding) {
  TexelArray result{image.width, image.height, {}};
  result.texels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::visit([&](const auto& rgba) { decode(rgba, encoding, result.texels); }, image.rgba);
  return result;
}

}  // namespace alabaster
