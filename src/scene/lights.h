#pragma once

#include <cstdint>
#include <filesystem>
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
  double pdf = 0;       // per solid angle, times the probability of the light's choice; for delta lights the
                        // latter alone
  bool delta = false;   // a ray cannot find this light: no MIS
};

/// A direction above a surface.
struct HemisphereSample {
  Vec3 direction{0};  // unit
  double pdf = 0;     // per solid angle
};

/// Light from far away: constant, analytic sky, or a lat-long image. Importance sampled.
class Environment {
 public:
  virtual ~Environment() = default;
  /// Arriving from unit `direction`.
  virtual Rgb radiance(const Vec3& direction) const = 0;
  /// Nothing where the environment is black.
  virtual std::optional<LightSample> sample(Vec2 u) const = 0;
  /// Density of sample() per solid angle, positive wherever radiance() is.
  virtual double pdf(const Vec3& direction) const = 0;
  /// A direction for light that crosses a surface of that unit normal: a mixture of sample() and the cosine
  /// lobe. Its density is positive on the whole hemisphere, so that one ray serves the environment and what
  /// other surfaces send. It may lie below the surface: then it counts as 0.
  virtual HemisphereSample sample_hemisphere(const Vec3& normal, Vec2 u) const;
  /// Density of sample_hemisphere() per solid angle.
  virtual double pdf_hemisphere(const Vec3& normal, const Vec3& direction) const;
  /// Mean over the sphere: weighs the environment against other lights.
  virtual Rgb mean_radiance() const = 0;
};

struct SkyParameters {
  Rgb ambient{0.15}, key{3.0};
  double exponent = 4;
  Vec3 direction{-0.6, 0.62, 0.5};
};

/// ambient + key max(0, w . direction)^exponent; `direction` need not be unit.
std::unique_ptr<Environment> make_sky_environment(const SkyParameters& parameters);
std::unique_ptr<Environment> make_constant_environment(const Rgb& radiance);
/// A latitude-longitude image, bilinear: rows from +y (top) to -y, the centre of the image shows -z and its
/// right half +x, turned by `rotation` radians counter-clockwise about +y (seen from above). The file's R G B
/// times `strength`. Throws InputError.
std::unique_ptr<Environment> load_latlong_environment(const std::filesystem::path& file, double rotation,
                                                      const Rgb& strength);
/// The same from texels in memory: width x height, row by row, finite and >= 0.
std::unique_ptr<Environment> make_latlong_environment(int width, int height, std::vector<Rgb> texels,
                                                      double rotation);

}  // namespace alabaster
