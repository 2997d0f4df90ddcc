#include <algorithm>
#include <cmath>
#include <limits>

#include "core/frame.h"
#include "scene/lights.h"

namespace alabaster {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3 uniform_sphere(Vec2 u) {
  const double z = 1 - 2 * u.x, phi = 2 * pi * u.y;
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

double cosine_pdf(const Vec3& normal, const Vec3& direction) {
  return std::max(0.0, glm::dot(normal, direction)) * inv_pi;
}

// Of the directions above a surface these follow the cosine alone, where the environment says nothing better:
// for what other surfaces send.
constexpr double cosine_share = 1.0 / 3;

class ConstantEnvironment final : public Environment {
 public:
  explicit ConstantEnvironment(const Rgb& radiance) : radiance_(radiance) {}

  Rgb radiance(const Vec3&) const override { return radiance_; }
  std::optional<LightSample> sample(Vec2 u) const override {
    if (radiance_.is_black()) return std::nullopt;
    return LightSample{uniform_sphere(u), infinity, radiance_, inv_pi / 4, false};
  }
  double pdf(const Vec3&) const override { return radiance_.is_black() ? 0 : inv_pi / 4; }
  Rgb mean_radiance() const override { return radiance_; }
  HemisphereSample sample_hemisphere(const Vec3& normal, Vec2 u) const override {
    const Vec3 direction = cosine_direction(normal, u);
    return {direction, cosine_pdf(normal, direction)};
  }
  double pdf_hemisphere(const Vec3& normal, const Vec3& direction) const override {
    return cosine_pdf(normal, direction);
  }

 private:
  Rgb radiance_;
};

/// Drawn from ambient and key lobe in proportion to their power: for grey skies pdf is exactly proportional
/// to radiance.
class SkyEnvironment final : public Environment {
 public:
  explicit SkyEnvironment(const SkyParameters& p)
      : ambient_(p.ambient), key_(p.key), exponent_(p.exponent), frame_(glm::normalize(p.direction)) {
    const double ambient_power = 4 * pi * ambient_.mean();
    const double key_power = 2 * pi / (exponent_ + 1) * key_.mean();
    total_ = ambient_power + key_power;
    key_share_ = total_ > 0 ? key_power / total_ : 0;
    // Irradiance of the key on a surface that faces it, and on one at a right angle relative to that: the
    // integral of 2 cos^n sin^2, a beta function.
    facing_ = 2 * pi / (exponent_ + 2) * key_.mean();
    sideways_ =
        std::exp(std::lgamma(0.5 * (exponent_ + 1)) + std::lgamma(1.5) - std::lgamma(0.5 * exponent_ + 2)) *
        (exponent_ + 2) / (2 * pi);
  }

  Rgb radiance(const Vec3& direction) const override { return ambient_ + key_ * lobe(direction); }

  std::optional<LightSample> sample(Vec2 u) const override {
    if (total_ <= 0) return std::nullopt;
    const Vec3 direction = u.x < key_share_ ? lobe_direction(frame_, exponent_, {u.x / key_share_, u.y})
                                            : uniform_sphere({(u.x - key_share_) / (1 - key_share_), u.y});
    return LightSample{direction, infinity, radiance(direction), pdf(direction), false};
  }

  double pdf(const Vec3& direction) const override {
    return key_share_ * (exponent_ + 1) / (2 * pi) * lobe(direction) + (1 - key_share_) * inv_pi / 4;
  }

  // The cosine lobe is just right for the ambient light, and a lobe between key and normal nearly so for the
  // key times the cosine.
  HemisphereSample sample_hemisphere(const Vec3& normal, Vec2 u) const override {
    const TiltedKey key = tilted_key(normal);
    const Vec3 direction = u.x < key.share
                               ? lobe_direction(Frame(key.axis), exponent_ + 1, {u.x / key.share, u.y})
                               : cosine_direction(normal, {(u.x - key.share) / (1 - key.share), u.y});
    return {direction, pdf_hemisphere(key, normal, direction)};
  }
  double pdf_hemisphere(const Vec3& normal, const Vec3& direction) const override {
    return pdf_hemisphere(tilted_key(normal), normal, direction);
  }

  Rgb mean_radiance() const override { return ambient_ + key_ * (0.5 / (exponent_ + 1)); }

 private:
  double lobe(const Vec3& direction) const {
    const double cosine = glm::dot(direction, frame_.normal);
    if (cosine <= 0) return 0;
    return exponent_ == 4 ? (cosine * cosine) * (cosine * cosine) : std::pow(cosine, exponent_);
  }

  // Density proportional to the n-th power of the cosine to the frame's normal: cos = v^(1/(n+1)).
  static Vec3 lobe_direction(const Frame& frame, double exponent, Vec2 u) {
    const double cosine = std::pow(1 - u.x, 1 / (exponent + 1)), phi = 2 * pi * u.y;
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return frame.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
  }

  // Where (w . key)^n (w . normal) is largest: at the angle t from the key with n tan t = tan(angle - t),
  // which is half of angle - asin((n - 1) / (n + 1) sin(angle)). The share is the key's of the irradiance,
  // within a few per cent; never so much that what other surfaces send would be left out.
  struct TiltedKey {
    Vec3 axis;
    double share;
  };
  TiltedKey tilted_key(const Vec3& normal) const {
    constexpr double most = 0.8;
    const Vec3& key = frame_.normal;
    const double cosine = glm::dot(normal, key), q = (exponent_ - 1) / (exponent_ + 1);
    const double beyond = std::sqrt(std::max(0.0, 1 - q * q * (1 - cosine * cosine))) - q * cosine;
    const Vec3 axis = (1 + q) * key + beyond * normal;
    const double length2 = length_squared(axis);
    const double power = facing_ * 0.5 * (cosine + std::sqrt(cosine * cosine + 4 * sideways_ * sideways_));
    const double ambient = pi * ambient_.mean();
    if (!(length2 > 1e-6) || !(power > 0)) return {key, 0};
    return {axis / std::sqrt(length2), std::min(most, power / (power + ambient))};
  }
  double pdf_hemisphere(const TiltedKey& key, const Vec3& normal, const Vec3& direction) const {
    const double cosine = glm::dot(direction, key.axis);
    const double lobe = cosine > 0 ? (exponent_ == 4 ? (cosine * cosine) * (cosine * cosine) * cosine
                                                     : std::pow(cosine, exponent_ + 1))
                                   : 0;
    return key.share * (exponent_ + 2) / (2 * pi) * lobe + (1 - key.share) * cosine_pdf(normal, direction);
  }

  Rgb ambient_, key_;
  double exponent_, total_ = 0, key_share_ = 0;
  double facing_ = 0, sideways_ = 0;
  Frame frame_;
};

}  // namespace

HemisphereSample Environment::sample_hemisphere(const Vec3& normal, Vec2 u) const {
  Vec3 direction = normal;
  if (u.x < cosine_share) {
    direction = cosine_direction(normal, {u.x / cosine_share, u.y});
  } else if (const auto found = sample({(u.x - cosine_share) / (1 - cosine_share), u.y})) {
    direction = found->direction;
  } else {
    return {};
  }
  return {direction, Environment::pdf_hemisphere(normal, direction)};
}

double Environment::pdf_hemisphere(const Vec3& normal, const Vec3& direction) const {
  return cosine_share * cosine_pdf(normal, direction) + (1 - cosine_share) * pdf(direction);
}

std::unique_ptr<Environment> make_constant_environment(const Rgb& radiance) {
  return std::make_unique<ConstantEnvironment>(radiance);
}

std::unique_ptr<Environment> make_sky_environment(const SkyParameters& parameters) {
  return std::make_unique<SkyEnvironment>(parameters);
}

}  // namespace alabaster
