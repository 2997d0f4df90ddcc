#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "bssrdf/bssrdf.h"
#include "bssrdf/placements.h"
#include "integrators/integrator.h"
#include "integrators/light_disk_sampler.h"
#include "integrators/planar_scene.h"
#include "texture/gaussian_pyramid.h"
#include "texture/plane_pyramid.h"

namespace alabaster {

/// The albedo of a planar scene as the models read it.
class PlanarAlbedo final : public AlbedoField {
 public:
  explicit PlanarAlbedo(const PlanarScene& scene);
  Rgb at(const SurfacePoint& point) const override { return pyramid_.at(point.uv); }
  Rgb filtered(const KernelFootprint& footprint) const override;
  Rgb mixture(std::span<const KernelFootprint> footprints, std::span<const double> weights) const override;
  Rgb max() const override { return pyramid_.max(); }

 private:
  GaussianPyramid pyramid_;
  PlanePyramid planes_;
  bool square_texels_;  // on the surface: an isotropic Gaussian stays one
  double texels_per_metre_;
};

/// A model standing on a planar scene, with the albedo field and the kernel placement it reads. Thread-safe.
class PlanarModel {
 public:
  /// `model` as in make_bssrdf(); `profile` must be that of the scene's g and eta and outlive this. Throws
  /// InputError.
  PlanarModel(const PlanarScene& scene, std::string_view model, const ProfileTable& profile,
              BssrdfOptions options = {});

  /// The surface point at a place of the plane.
  SurfacePoint surface(Vec2 p) const;
  BssrdfPoint point(Vec2 p) const { return bssrdf_->medium().point(surface(p)); }
  /// The same for light that leaves there, as the scene's view sees it.
  BssrdfPoint exit(Vec2 p) const;
  const Bssrdf& bssrdf() const { return *bssrdf_; }
  const PlanarScene& scene() const { return scene_; }

 private:
  PlanarScene scene_;
  PlanarAlbedo albedo_;
  PlanarPlacement placement_;
  std::unique_ptr<Bssrdf> bssrdf_;
};

/// How entry points are drawn.
enum class PlanarSampling {
  uniform,  // over the light's area: what [EK17] does
  profile,  // a distance from the profile at the exit, any angle; misses the light at will
  mis,      // each of the two by chance, weighted by the balance heuristic
  clipped,  // as mis, but the profile confined to the light (light_disk_sampler.h)
};
/// Parses the names above; throws InputError.
PlanarSampling planar_sampling_from_name(std::string_view name);

/// The SV-BSSRDF models in the flat laboratory: one entry point per sample,
/// L = T(cos_o) / (pi c) * integral of S_V E dA over the light (docs/theory.md), the specular term left
/// out. The evaluation of S_V is the surface integrator's.
class PlanarIntegrator final : public Integrator {
 public:
  /// `model` must outlive this. Light on the whole plane can be sampled by the profile only, and always is.
  PlanarIntegrator(const PlanarModel& model, PlanarSampling sampling);

  PixelSample sample(int x, int y, const Sampler& sampler) const override;
  int width() const override { return scene_.view.width; }
  int height() const override { return scene_.view.height; }

  /// The part of a sample that is not the exit point: an estimate of the radiance at `exit`.
  Rgb radiance(const BssrdfPoint& exit, const Sampler& sampler) const;

 private:
  struct Strategies;
  struct Entry {
    Vec2 point{0};
    double pdf = 0;  // per m^2
  };
  Strategies strategies(const BssrdfPoint& exit) const;
  std::optional<Entry> draw(const Strategies& s, Vec2 u) const;
  std::optional<Entry> with_pdf(const Strategies& s, Vec2 entry) const;
  std::optional<Entry> with_pdf(const Strategies& s, Vec2 entry, const LightDiskSampler::Place& place) const;
  double mixture(const Strategies& s, double by_profile) const;
  const LightDiskSampler& light_sampler(int channel) const {
    return light_samplers_[light_samplers_.size() == 1 ? 0 : static_cast<std::size_t>(channel)];
  }
  double profile_share(double offset) const;
  void tabulate_profile_share();

  const PlanarModel& model_;
  const PlanarScene& scene_;
  PlanarSampling sampling_;
  double light_reach_;  // m, radius of the disk around the light
  std::vector<double>
      profile_share_;  // mis: by the exit's distance from the light's centre, light_reach_ / 8 apart
  std::vector<LightDiskSampler> light_samplers_;  // clipped: one, or one per channel
  double outgoing_;  // T(cos_o), or c for radiosity / pi: what E / pi c times the integral of S_V is
                     // multiplied by
};

}  // namespace alabaster
