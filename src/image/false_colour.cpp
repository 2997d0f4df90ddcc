#include "image/false_colour.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>

#include "core/vec.h"
#include "image/srgb.h"

namespace alabaster {

namespace {

// Oklab (B. Ottosson 2020, "A perceptual color space for image processing") to linear sRGB.
Rgb from_oklab(double lightness, double a, double b) {
  const auto cube = [](double v) { return v * v * v; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool in_gamut(const Rgb& c) {
  return c.min() >= 0 && c.max() <= 1;
}

// The colour of that lightness and hue (degrees), with as much of the chroma as sRGB can show.
Rgb from_oklch(double lightness, double chroma, double hue) {
  const Vec2 direction(std::cos(hue * pi / 180), std::sin(hue * pi / 180));
  double low = 0, high = chroma;
  for (int i = 0; i < 12 && !in_gamut(from_oklab(lightness, high * direction.x, high * direction.y)); ++i) {
    const double middle = 0.5 * (low + high);
    (in_gamut(from_oklab(lightness, middle * direction.x, middle * direction.y)) ? low : high) = middle;
    if (i == 11) high = low;
  }
  const Rgb c = from_oklab(lightness, high * direction.x, high * direction.y);
  return {std::clamp(c.r, 0.0, 1.0), std::clamp(c.g, 0.0, 1.0), std::clamp(c.b, 0.0, 1.0)};
}

// Glyphs of 3 x 5 dots, rows from the top, the leftmost dot in bit 2.
struct Glyph {
  char character;
  std::array<uint8_t, 5> rows;
};
constexpr std::array<Glyph, 15> glyphs{{{'0', {7, 5, 5, 5, 7}},
                                        {'1', {2, 6, 2, 2, 7}},
                                        {'2', {7, 1, 7, 4, 7}},
                                        {'3', {7, 1, 7, 1, 7}},
                                        {'4', {5, 5, 7, 1, 1}},
                                        {'5', {7, 4, 7, 1, 7}},
                                        {'6', {7, 4, 7, 5, 7}},
                                        {'7', {7, 1, 1, 2, 2}},
                                        {'8', {7, 5, 7, 5, 7}},
                                        {'9', {7, 5, 7, 1, 7}},
                                        {'.', {0, 0, 0, 0, 2}},
                                        {'-', {0, 0, 7, 0, 0}},
                                        {'+', {0, 2, 7, 2, 0}},
                                        {'e', {0, 7, 7, 4, 7}},
                                        {' ', {0, 0, 0, 0, 0}}}};
constexpr int dot = 2, glyph_advance = 4 * dot, text_height = 5 * dot;

void draw_text(Pixels8& picture, int x, int y, const std::string& text) {
  for (const char character : text) {
    const auto glyph =
        std::find_if(glyphs.begin(), glyphs.end(), [&](const Glyph& g) { return g.character == character; });
    if (glyph == glyphs.end()) continue;
    for (int row = 0; row < text_height; ++row)
      for (int column = 0; column < 3 * dot; ++column)
        if ((glyph->rows[static_cast<std::size_t>(row / dot)] >> (2 - column / dot)) & 1)
          if (x + column >= 0 && x + column < picture.width && y + row < picture.height)
            std::fill_n(picture.at(x + column, y + row), 3, uint8_t{0});
    x += glyph_advance;
  }
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

void set_pixel(Pixels8& picture, int x, int y, const Rgb& linear) {
  uint8_t* out = picture.at(x, y);
  for (int c = 0; c < 3; ++c) out[c] = linear_to_srgb8(linear[c]);
}

}  // namespace

Rgb sequential_colour(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return from_oklch(0.18 + 0.78 * t, 0.10 + 0.06 * std::sin(pi * t), 305 - 200 * t);
}

Rgb diverging_colour(double t) {
  t = std::clamp(t, -1.0, 1.0);
  const double strength = std::abs(t);
  return from_oklch(0.97 - 0.55 * strength, 0.19 * std::sin(0.5 * pi * strength), t < 0 ? 255 : 28);
}

double ColourScale::position(double value) const {
  const double magnitude = std::abs(value);
  double t;
  if (logarithmic)
    t = magnitude > low ? std::log(magnitude / low) / std::log(high / low) : 0;
  else
    t = is_signed ? magnitude / high : (value - low) / (high - low);
  if (!is_signed) return logarithmic && value <= 0 ? 0 : std::clamp(t, 0.0, 1.0);
  return std::copysign(std::clamp(t, 0.0, 1.0), value);
}

double ColourScale::value_at(double position) const {
  const double t = std::abs(position);
  const double magnitude = logarithmic ? low * std::pow(high / low, t)
                           : is_signed ? t * high
                                       : low + t * (high - low);
  return is_signed ? (logarithmic && t == 0 ? 0 : std::copysign(magnitude, position)) : magnitude;
}

Rgb ColourScale::colour(double value) const {
  if (std::isnan(value)) return {1, 0, 1};
  return is_signed ? diverging_colour(position(value)) : sequential_colour(position(value));
}

ColourScale fitted_scale(std::span<const float> values, bool is_signed, double percentile) {
  std::vector<float> magnitudes;
  for (const float v : values)
    if (std::isfinite(v)) magnitudes.push_back(std::abs(v));
  ColourScale scale;
  scale.is_signed = is_signed;
  if (magnitudes.empty()) return scale;
  const auto rank = static_cast<std::ptrdiff_t>(std::clamp(percentile / 100, 0.0, 1.0) *
                                                static_cast<double>(magnitudes.size() - 1));
  std::nth_element(magnitudes.begin(), magnitudes.begin() + rank, magnitudes.end());
  scale.high = static_cast<double>(magnitudes[static_cast<std::size_t>(rank)]);
  if (scale.high == 0)
    scale.high = static_cast<double>(*std::max_element(magnitudes.begin(), magnitudes.end()));
  if (!(scale.high > 0)) scale.high = 1;
  return scale;
}

Pixels8 false_colour(std::span<const float> values, int width, int height, const ColourScale& scale) {
  assert(values.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  Pixels8 picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      set_pixel(picture, x, y,
                scale.colour(
                    static_cast<double>(values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                               static_cast<std::size_t>(x)])));
  return picture;
}

Pixels8 with_legend(const Pixels8& picture, const ColourScale& scale) {
  constexpr int bar_height = 12, gap = 4;
  assert(picture.channels == 3);
  Pixels8 result(std::max(picture.width, 160), picture.height + bar_height + text_height + 3 * gap, 3);
  std::fill(result.bytes.begin(), result.bytes.end(), uint8_t{255});
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(
        picture.bytes.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) * 3,
        picture.width * 3, result.at(0, y));
  const double first = scale.is_signed ? -1 : 0;
  for (int x = 0; x < result.width; ++x) {
    const double t = first + (1 - first) * (x + 0.5) / result.width;
    const Rgb colour = scale.is_signed ? diverging_colour(t) : sequential_colour(t);
    for (int y = 0; y < bar_height; ++y) set_pixel(result, x, picture.height + gap + y, colour);
  }
  for (int tick = 0; tick < 3; ++tick) {
    const std::string text = number_text(scale.value_at(first + (1 - first) * 0.5 * tick));
    const int width = static_cast<int>(text.size()) * glyph_advance;
    draw_text(result, (result.width - width) * tick / 2 + (tick == 0 ? 1 : 0),
              picture.height + 2 * gap + bar_height, text);
  }
  return result;
}

std::vector<float> signed_difference(const Image& a, const ColourChannels& colour_a, const Image& b,
                                     const ColourChannels& colour_b) {
  assert(a.width() == b.width() && a.height() == b.height());
  std::vector<float> result;
  result.reserve(static_cast<std::size_t>(a.width()) * static_cast<std::size_t>(a.height()));
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x)
      result.push_back(static_cast<float>((colour_a.get(a, x, y) - colour_b.get(b, x, y)).mean()));
  return result;
}

}  // namespace alabaster
