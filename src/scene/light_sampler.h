#pragma once

#include <optional>
#include <vector>

#include "geometry/ray_scene.h"
#include "scene/discrete_distribution.h"
#include "scene/lights.h"

namespace alabaster {

struct Scene;

/// A disk light met by a ray: disks are no part of the ray scene.
struct DiskHit {
  double t = 0;
  Rgb radiance;
  std::size_t light = 0;  // index into Scene::lights
};

/// Chooses a light by its estimated contribution at a point, then a direction towards it. Lights below the
/// horizon of `normal` are left out; a normal of zero keeps all. Patch lights are never sampled: they
/// are added through uniform_radiance(). Thread-safe; keeps a reference to the scene.
class LightSampler {
 public:
  enum class Lights { all, but_environment };
  /// Point, spot and directional lights fill a cone of that full angle (radians) around their direction, with
  /// a radiance that leaves the irradiance of a surface above whose horizon they stand as it was; 0: they
  /// have no size, and no ray finds them.
  explicit LightSampler(const Scene& scene, double angular_size = 0, Lights lights = Lights::all);

  /// One direction. `pdf` holds the choice of the light as well. Nothing where no light can reach.
  std::optional<LightSample> sample(const Vec3& point, const Vec3& normal, double u_choice, Vec2 u) const;

  /// The density with which sample() draws `direction` from `point`, per solid angle, when the ray left for
  /// the environment, met an emissive triangle, or met a disk. 0 where sample() never would.
  double pdf_environment(const Vec3& point, const Vec3& normal, const Vec3& direction) const;
  double pdf_triangle(const Vec3& point, const Vec3& normal, const Vec3& direction, const Hit& hit) const;
  double pdf_disk(const Vec3& point, const Vec3& normal, const Vec3& direction, const DiskHit& hit) const;

  double pdf_cone(const Vec3& point, const Vec3& normal, const DiskHit& hit) const;

  /// Lights of an angular size: whether the cone numbered `i`, as seen from the ray's origin, holds its
  /// direction (unit), and the light is closer than the ray's end.
  std::size_t cone_count() const { return cones_.size(); }
  std::optional<DiskHit> cone(std::size_t i, const Ray& ray) const;

  /// The nearest disk light along a ray, seen from its emitting side.
  std::optional<DiskHit> nearest_disk(const Ray& ray) const;
  /// Radiance an emissive triangle sends against `direction`; black for others and for the back side of
  /// single-sided materials.
  Rgb emitted(const Hit& hit, const Vec3& direction) const;

  /// Sum of the patch lights' radiances at a surface point: incident from the whole hemisphere, unoccluded. A
  /// dielectric surface takes in E = pi c L of it (docs/theory.md).
  Rgb uniform_radiance(const Vec3& point) const;

  bool has_lights() const { return !entries_.empty(); }

  /// Whether there are lights that no ray can find.
  bool has_sizeless() const;

  // Directions of concentrated light alone, whatever else lies along them: disks, cones, and an environment
  // with most of its light in a small part of the sphere. Emissive triangles are left out, since only tracing
  // tells in which direction they are.
  bool has_concentrated() const;
  std::optional<LightSample> sample_concentrated(const Vec3& point, const Vec3& normal, double u_choice,
                                                 Vec2 u) const;
  /// The density with which sample_concentrated() draws `direction`, all lights together.
  double pdf_concentrated(const Vec3& point, const Vec3& normal, const Vec3& direction) const;
  /// Radiance of environment, disks and cones from `direction`, unoccluded.
  Rgb radiance_along(const Vec3& point, const Vec3& direction) const;
  /// About the mean over all directions of what arrives at a point, all lights together.
  double typical_radiance(const Vec3& point) const { return total_weight(point, Vec3(0)) / pi; }

 private:
  enum class Kind : uint8_t { environment, delta, cone, disk, triangles };
  struct Entry {
    Kind kind;
    std::size_t light = 0;  // index into Scene::lights; unused for environment and triangles
  };
  double weight(const Entry& entry, const Vec3& point, const Vec3& normal) const;
  double total_weight(const Vec3& point, const Vec3& normal) const;
  /// Probability that the entry of that kind (and light) is chosen at the point.
  double choice_probability(Kind kind, std::size_t light, const Vec3& point, const Vec3& normal) const;
  bool is_concentrated(const Entry& entry) const;
  std::optional<DiskHit> disk_along(std::size_t i, const Ray& ray) const;
  std::optional<LightSample> sample_entry(const Entry& entry, const Vec3& point, Vec2 u) const;
  std::optional<LightSample> sample_triangle(const Vec3& point, Vec2 u) const;
  std::optional<LightSample> sample_cone(const Light& light, const Vec3& point, Vec2 u) const;
  std::optional<LightSample> sample_disk(const DiskLight& disk, const Vec3& point, Vec2 u) const;

  const Scene& scene_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> patches_, disks_, cones_;
  double cone_cosine_ = 1;                 // of half the angular size
  double cone_projected_solid_angle_ = 0;  // of a cone about the normal
  double environment_power_ = 0;           // pi x mean radiance
  bool environment_concentrated_ = false;
  std::vector<TriangleLight> triangles_;
  DiscreteDistribution triangle_choice_;
  std::vector<std::vector<uint32_t>> triangle_slot_;  // per object, per triangle: index or no_index
  double triangle_power_ = 0;                         // W, mean over channels
  Vec3 triangle_centre_{0};
  double triangle_radius_ = 0;
};

}  // namespace alabaster
