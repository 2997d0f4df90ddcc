#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/rgb.h"

namespace alabaster {

/// Named float channels of one size, each a plane of width x height, row 0 at the top.
class Image {
 public:
  Image() = default;
  Image(int width, int height, std::vector<std::string> channels);

  int width() const { return width_; }
  int height() const { return height_; }
  const std::vector<std::string>& channels() const { return names_; }
  /// Index of a channel by name, -1 if there is none.
  int find(const std::string& channel) const;

  float* plane(int channel) { return planes_[static_cast<std::size_t>(channel)].data(); }
  const float* plane(int channel) const { return planes_[static_cast<std::size_t>(channel)].data(); }
  float& at(int channel, int x, int y) {
    return plane(channel)[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                          static_cast<std::size_t>(x)];
  }
  float at(int channel, int x, int y) const {
    return plane(channel)[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                          static_cast<std::size_t>(x)];
  }

  /// Three channels as a triple; `first` is the index of the first of three consecutive ones.
  Rgb rgb(int first, int x, int y) const {
    return {at(first, x, y), at(first + 1, x, y), at(first + 2, x, y)};
  }
  void set_rgb(int first, int x, int y, const Rgb& c);

  /// Appends a channel, filled with `value`; returns its index.
  int add_channel(const std::string& name, float value = 0);

 private:
  int width_ = 0, height_ = 0;
  std::vector<std::string> names_;
  std::vector<std::vector<float>> planes_;
};

/// Where a picture's colour stands among the channels of an image.
struct ColourChannels {
  std::array<int, 3> rgb{-1, -1, -1};  // all three the same for a grey picture
  int alpha = -1;                      // -1 if there is none
  std::string layer;                   // "ViewLayer.Combined"; empty for plain R, G, B

  Rgb get(const Image& image, int x, int y) const {
    return {image.at(rgb[0], x, y), image.at(rgb[1], x, y), image.at(rgb[2], x, y)};
  }
};

/// R, G, B (and A) of one layer, "" for the channels without a prefix; nothing when one of R, G, B is
/// missing.
std::optional<ColourChannels> find_layer(const Image& image, const std::string& layer);
/// The picture in an image of any renderer: plain R G B, else a layer called Combined, Beauty or Color, else
/// the first layer with R, G and B that is not auxiliary (variance, albedo, normal ...), else grey (Y).
std::optional<ColourChannels> find_colour(const Image& image);

}  // namespace alabaster
