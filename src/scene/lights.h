#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "core/rgb.h"
#include "core/vec.h"

namespace alabaster {

struct PointLight {
  Vec3 position;
  Rgb intensity;
};  // W/sr
struct SpotLight {
  Vec3 position, direction;
  Rgb intensity;
  double inner_cone, outer_cone;
};  // radians, half angles
struct DirectionalLight {
  Vec3 direction;
  Rgb irradiance;
};  // direction light travels; on a surface facing it
struct DiskLight {
  Vec3 position, direction;
  double radius;
  Rgb radiance;
};  // emits on the side of direction
/// Uniform diffuse incident radiance on every surface point within `radius` of `position`, unoccluded: what
/// [EK17] uses.
struct PatchLight {
  Vec3 position;
  double radius;
  Rgb radiance;
};
/// A triangle of an emissive object.
struct TriangleLight {
  uint32_t object, triangle;
};

using Light = std::variant<PointLight, SpotLight, DirectionalLight, DiskLight, PatchLight, TriangleLight>;

/// One sampled direction towards a light.
struct LightSample {
  Vec3 direction{0};    // unit, from the shaded point to the light
  double distance = 0;  // m; infinity for the environment
  Rgb radiance;         // arriving, unoccluded; for delta lights radiance / pdf is the irradiance on a facing
                        // surface
  double pdf = 0;       // per solid angle; 1 for delta lights
  bool delta = false;
};

/// Light from far away: constant, analytic sky, or a lat-long image. Importance sampled.
class Environment {
 public:
  virtual ~Environment() = default;
  virtual Rgb radiance(const Vec3& direction) const = 0;
  virtual LightSample sample(Vec2 u) const = 0;
  virtual double pdf(const Vec3& direction) const = 0;
};

struct SkyParameters {
  Rgb ambient{0.15}, key{3.0};
  double exponent = 4;
  Vec3 direction{-0.6, 0.62, 0.5};
};

std::unique_ptr<Environment> make_constant_environment(const Rgb& radiance);
/// ambient + key max(0, w . direction)^exponent
std::unique_ptr<Environment> make_sky_environment(const SkyParameters& parameters);

}  // namespace alabaster
