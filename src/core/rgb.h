#pragma once

#include <algorithm>
#include <cmath>

namespace alabaster {

/// A linear RGB triple: radiance, albedo, or a coefficient per channel.
struct Rgb {
  double r = 0, g = 0, b = 0;

  constexpr Rgb() = default;
  constexpr explicit Rgb(double v) : r(v), g(v), b(v) {}
  constexpr Rgb(double red, double green, double blue) : r(red), g(green), b(blue) {}

  constexpr double& operator[](int channel) { return channel == 0 ? r : channel == 1 ? g : b; }
  constexpr double operator[](int channel) const { return channel == 0 ? r : channel == 1 ? g : b; }

  constexpr Rgb& operator+=(const Rgb& o) { return r += o.r, g += o.g, b += o.b, *this; }
  constexpr Rgb& operator-=(const Rgb& o) { return r -= o.r, g -= o.g, b -= o.b, *this; }
  constexpr Rgb& operator*=(const Rgb& o) { return r *= o.r, g *= o.g, b *= o.b, *this; }
  constexpr Rgb& operator/=(const Rgb& o) { return r /= o.r, g /= o.g, b /= o.b, *this; }
  constexpr Rgb& operator*=(double s) { return r *= s, g *= s, b *= s, *this; }
  constexpr Rgb& operator/=(double s) { return r /= s, g /= s, b /= s, *this; }
  constexpr bool operator==(const Rgb&) const = default;

  constexpr double max() const { return std::max(r, std::max(g, b)); }
  constexpr double min() const { return std::min(r, std::min(g, b)); }
  constexpr double mean() const { return (r + g + b) / 3; }
  constexpr bool is_black() const { return r == 0 && g == 0 && b == 0; }
  /// All three channels share one value, so per-channel work can be done once.
  constexpr bool is_grey() const { return r == g && g == b; }
  bool is_finite() const { return std::isfinite(r) && std::isfinite(g) && std::isfinite(b); }
};

constexpr Rgb operator+(Rgb a, const Rgb& b) {
  return a += b;
}
constexpr Rgb operator-(Rgb a, const Rgb& b) {
  return a -= b;
}
constexpr Rgb operator*(Rgb a, const Rgb& b) {
  return a *= b;
}
constexpr Rgb operator/(Rgb a, const Rgb& b) {
  return a /= b;
}
constexpr Rgb operator*(Rgb a, double s) {
  return a *= s;
}
constexpr Rgb operator*(double s, Rgb a) {
  return a *= s;
}
constexpr Rgb operator/(Rgb a, double s) {
  return a /= s;
}

/// Rec. 709 luminance of a linear triple.
constexpr double luminance(const Rgb& c) {
  return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
}

}  // namespace alabaster
