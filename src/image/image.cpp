#include "image/image.h"

#include <algorithm>
#include <cassert>

namespace alabaster {

namespace {

std::size_t pixel_count(int width, int height) {
  assert(width >= 0 && height >= 0);
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

std::string layer_of(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == std::string::npos ? std::string() : channel.substr(0, dot);
}

// Layers that renderers write beside the picture itself.
bool is_auxiliary(const std::string& layer) {
  const std::string last = lower_case(layer.substr(layer.rfind('.') + 1));
  for (const char* name : {"variance", "albedo", "normal", "depth", "samples", "relvar", "position",
                           "denoising", "denoising albedo", "denoising normal", "uv", "vector", "mist", "ns"})
    if (last == name) return true;
  return false;
}

}  // namespace

Image::Image(int width, int height, std::vector<std::string> channels)
    : width_(width),
      height_(height),
      names_(std::move(channels)),
      planes_(names_.size(), std::vector<float>(pixel_count(width, height))) {}

int Image::find(const std::string& channel) const {
  const auto found = std::find(names_.begin(), names_.end(), channel);
  return found == names_.end() ? -1 : static_cast<int>(found - names_.begin());
}

void Image::set_rgb(int first, int x, int y, const Rgb& c) {
  at(first, x, y) = static_cast<float>(c.r);
  at(first + 1, x, y) = static_cast<float>(c.g);
  at(first + 2, x, y) = static_cast<float>(c.b);
}

int Image::add_channel(const std::string& name, float value) {
  assert(find(name) < 0);
  names_.push_back(name);
  planes_.emplace_back(pixel_count(width_, height_), value);
  return static_cast<int>(names_.size()) - 1;
}

std::optional<ColourChannels> find_layer(const Image& image, const std::string& layer) {
  const std::string prefix = layer.empty() ? "" : layer + ".";
  for (const char* names : {"RGBA", "rgba"}) {
    ColourChannels found;
    found.layer = layer;
    for (std::size_t c = 0; c < 3; ++c) found.rgb[c] = image.find(prefix + names[c]);
    found.alpha = image.find(prefix + names[3]);
    if (*std::min_element(found.rgb.begin(), found.rgb.end()) >= 0) return found;
  }
  return std::nullopt;
}

std::optional<ColourChannels> find_colour(const Image& image) {
  if (auto plain = find_layer(image, "")) return plain;
  std::optional<ColourChannels> first, auxiliary;
  for (const std::string& channel : image.channels()) {
    const std::string layer = layer_of(channel);
    if (layer.empty()) continue;
    const auto found = find_layer(image, layer);
    if (!found) continue;
    const std::string last = lower_case(layer.substr(layer.rfind('.') + 1));
    if (last == "combined" || last == "beauty" || last == "color") return found;
    auto& slot = is_auxiliary(layer) ? auxiliary : first;
    if (!slot) slot = found;
  }
  if (first) return first;
  for (const char* name : {"Y", "L", "y"})
    if (const int grey = image.find(name); grey >= 0)
      return ColourChannels{{grey, grey, grey}, image.find("A"), ""};
  return auxiliary;
}

}  // namespace alabaster
