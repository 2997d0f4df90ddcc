#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bssrdf/basis.h"
#include "bssrdf/expected_light.h"
#include "integrators/integrator.h"
#include "integrators/interaction.h"
#include "integrators/light_guide.h"
#include "integrators/subsurface_transport.h"
#include "integrators/volume_walk.h"
#include "scene/light_sampler.h"
#include "scene/scene.h"

namespace alabaster {

/// How light travels below the surfaces.
enum class Transport {
  bssrdf,  // a BSSRDF model between entry and exit
  volume,  // random walks through the volume, the albedo read at the closest surface point: the reference
  walk     // the same walks with the exit's albedo everywhere
};

/// What the first surface sends to the camera, in parts that add up to the whole.
enum class Layer {
  all,
  scattered,    // left a body after it scattered there, diffuse bodies included
  unscattered,  // crossed a medium or a thin wall without scattering; also what is seen of lights themselves
  mirror        // was reflected by the interface
};

struct SurfaceOptions {
  int width = 512, height = 512;  // of the whole image, pixels
  Camera camera;
  Transport transport = Transport::bssrdf;
  std::string model = "composite";  // of Transport::bssrdf, see make_bssrdf()
  Basis basis = Basis::half_space;  // of that model
  VolumeWalkOptions walk;           // of Transport::volume and Transport::walk; which albedo is theirs to say
  std::string placement = "chord";  // of its kernel, see make_placement()
  std::string distance = "chord";   // that its basis is asked for, see make_surface_distance()
  /// Diffuse bounces between surfaces; 0: direct light only.
  int depth = 4;
  bool environment_visible = true;  // to camera rays
  Layer layer = Layer::all;
  /// Full angle, radians, that point, spot and directional lights fill as seen from every point, with the
  /// irradiance they give kept; 0: they have no size. Absent: 0 for Transport::bssrdf and one degree for
  /// walks, which cannot find lights without size through a smooth boundary.
  std::optional<double> angular_size;
  /// Without: neither the mirror term nor light that never scattered, only what left a surface's body.
  bool specular = true;
};

/// Radiance of a scene by docs/theory.md: every surface is a dielectric (or metal) interface over a body.
/// The interface mirrors; the body is a BSSRDF where the material has a medium and diffuse where it has not.
/// Light that crosses a medium without scattering is traced as a path of its own. docs/rendering.md has the
/// estimators.
///
/// The scene outlives the integrator.
class SurfaceIntegrator final : public Integrator {
 public:
  SurfaceIntegrator(const Scene& scene, const SurfaceOptions& options);
  ~SurfaceIntegrator() override;

  PixelSample sample(int x, int y, const Sampler& sampler) const override;
  int width() const override { return options_.width; }
  int height() const override { return options_.height; }

  /// Lines about the work below the surfaces so far.
  std::vector<std::string> report() const;

 private:
  struct Interface;  // what is fixed for a material
  struct Body;       // what light meets below the surfaces of one medium of one object
  struct Path;       // the state of one pixel sample
  struct Arrival;    // how a ray came to be traced

  /// Radiance that comes in along a ray.
  Rgb incoming(const Ray& ray, const Arrival& arrival, Path& path) const;
  Rgb environment(const Ray& ray, const Arrival& arrival) const;
  bool shows(Layer layer, const Arrival& arrival) const;
  Rgb disks(const Ray& ray, double t_max, const Arrival& arrival) const;
  Rgb emission(const Ray& ray, const Hit& hit, const Arrival& arrival) const;
  /// What a surface sends towards the ray's origin, emission apart.
  Rgb outgoing(const Interaction& it, const Arrival& arrival, Path& path) const;

  // The three parts of it; each comes with the factor that the interface puts on it.
  Rgb mirrored(const Interaction& it, const Arrival& arrival, Path& path) const;
  Rgb from_body(const Interaction& it, const Arrival& arrival, Path& path) const;
  Rgb unscattered(const Interaction& it, const Body& body, const Arrival& arrival, Path& path) const;

  Rgb mirrored_rough(const Interaction& it, const Arrival& arrival, Path& path) const;
  Rgb straight_through(const Interaction& it, const Arrival& arrival, Path& path) const;
  Rgb subsurface(const Interaction& it, const Body& body, const Arrival& arrival, Path& path) const;
  /// Estimates the integral of T(cos) L cos over the hemisphere: direct light, and one bounce on.
  Rgb entering(const SurfacePoint& point, const Vec3& mirror_normal, const Interface& interface,
               double weight, const Arrival& arrival, Path& path, const LightAim& aim = {}) const;
  Rgb entering_along(const SubsurfaceEntry& entry, const Arrival& arrival, Path& path) const;
  Rgb entering_from_light(const SurfacePoint& point, const Vec3& mirror_normal, const Interface& interface,
                          uint32_t vertex, const Path& path, const LightAim& aim) const;

  Rgb unscattered_share(const Body& body, const Ray& ray, double distance, Rng rng) const;
  struct Look;  // where entering() looks for the environment and other surfaces
  Look look(const SurfacePoint& point, const Vec3& mirror_normal, const Interface& interface, Vec2 u) const;
  /// One of several, by what light and its aim promise there.
  Look look_aimed(const SurfacePoint& point, const Vec3& mirror_normal, const Interface& interface,
                  const LightAim& aim, uint32_t vertex, const Path& path) const;
  /// Density of the direction in which entering() looks for the environment and other surfaces.
  double entering_pdf(const Vec3& normal, const Vec3& direction) const;

  Rgb fresnel(const Interaction& it, double cosine) const;
  double opacity_number(const Path& path, uint32_t vertex) const;
  Ray leaving(const SurfacePoint& point, const Vec3& direction) const;
  bool lit(const SurfacePoint& point, const LightSample& light, double opacity_number) const;

  void prepare_bodies();
  std::unique_ptr<SubsurfaceTransport> make_transport(uint32_t object, const Medium& medium,
                                                      std::vector<uint8_t> boundary) const;
  const Body* body(const Interaction& it) const;

  const Scene& scene_;
  SurfaceOptions options_;
  CameraRays camera_;
  LightSampler lights_;
  LightSampler near_lights_;  // all but the environment, which the ray that looks for other surfaces finds
  LightGuide guide_;
  std::optional<ExpectedLight> expected_light_;  // where a few directions and places tell it
  double offset_;                                // m: how far rays start off a surface
  double unseen_radiance_ = 1;                   // what other surfaces may be expected to send
  bool stochastic_opacity_ = false;
  std::vector<Interface> interfaces_;  // per material
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::vector<const Body*>> body_of_;  // object x material
};

}  // namespace alabaster
