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
  }

  Rgb radiance(const Vec3& direction) const override { return ambient_ + key_ * lobe(direction); }

  std::optional<LightSample> sample(Vec2 u) const override {
    if (total_ <= 0) return std::nullopt;
    Vec3 direction;
    if (u.x < key_share_) {
      // Density proportional to cos^n: cos = v^(1/(n+1)).
      const double cosine = std::pow(1 - u.x / key_share_, 1 / (exponent_ + 1)), phi = 2 * pi * u.y;
      const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
      direction = frame_.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
    } else {
      direction = uniform_sphere({(u.x - key_share_) / (1 - key_share_), u.y});
    }
    return LightSample{direction, infinity, radiance(direction), pdf(direction), false};
  }

  double pdf(const Vec3& direction) const override {
    return key_share_ * (exponent_ + 1) / (2 * pi) * lobe(direction) + (1 - key_share_) * inv_pi / 4;
  }

  Rgb mean_radiance() const override { return ambient_ + key_ * (0.5 / (exponent_ + 1)); }

 private:
  double lobe(const Vec3& direction) const {
    const double cosine = glm::dot(direction, frame_.normal);
    if (cosine <= 0) return 0;
    return exponent_ == 4 ? (cosine * cosine) * (cosine * cosine) : std::pow(cosine, exponent_);
  }

  Rgb ambient_, key_;
  double exponent_, total_ = 0, key_share_ = 0;
  Frame frame_;
};

}  // namespace

std::unique_ptr<Environment> make_constant_environment(const Rgb& radiance) {
  return std::make_unique<ConstantEnvironment>(radiance);
}

std::unique_ptr<Environment> make_sky_environment(const SkyParameters& parameters) {
  return std::make_unique<SkyEnvironment>(parameters);
}

}  // namespace alabaster
