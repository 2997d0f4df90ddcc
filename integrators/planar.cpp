#include "integrators/planar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/error.h"
#include "optics/fresnel.h"

namespace alabaster {

PlanarAlbedo::PlanarAlbedo(const PlanarScene& scene)
    : pyramid_(*scene.albedo, {}, Wrap::repeat, Wrap::repeat),
      planes_(*scene.albedo),
      square_texels_(std::abs(scene.tile.x * scene.albedo->height - scene.tile.y * scene.albedo->width) <
                     1e-9 * scene.tile.x * scene.albedo->height),
      texels_per_metre_(scene.albedo->width / scene.tile.x) {}

Rgb PlanarAlbedo::filtered(const KernelFootprint& footprint) const {
  const double one = 1;
  return mixture({&footprint, 1}, {&one, 1});
}

Rgb PlanarAlbedo::mixture(std::span<const KernelFootprint> footprints,
                          std::span<const double> weights) const {
  Rgb sum;
  if (!square_texels_) {
    const Mat2 texels_from_uv(pyramid_.width(), 0, 0, pyramid_.height());
    for (std::size_t k = 0; k < footprints.size(); ++k) {
      const Mat2 j = footprints[k].sigma * texels_from_uv * footprints[k].uv_from_surface;
      sum += weights[k] * pyramid_.filtered(footprints[k].uv, j * glm::transpose(j));
    }
    return sum;
  }
  for (std::size_t first = 0; first < footprints.size(); first += PlanePyramid::most_at_once) {
    std::array<PlanePyramid::Gaussian, PlanePyramid::most_at_once> gaussians;
    const std::size_t count = std::min(gaussians.size(), footprints.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      const KernelFootprint& footprint = footprints[first + k];
      gaussians[k] = {footprint.uv, footprint.sigma * texels_per_metre_, weights[first + k]};
    }
    sum += planes_.sum(std::span(gaussians).first(count), pyramid_);
  }
  return sum;
}

namespace {

// Metres along Frame(+z)'s tangent (x) and bitangent (y) to texture coordinates.
Mat2 uv_from_surface(const PlanarScene& scene) {
  return Mat2(1 / scene.tile.x, 0, 0, -1 / scene.tile.y);
}

BssrdfOptions with_placement(BssrdfOptions options, const KernelPlacement& placement) {
  if (options.placement == nullptr) options.placement = &placement;
  return options;
}

}  // namespace

PlanarModel::PlanarModel(const PlanarScene& scene, std::string_view model, const ProfileTable& profile,
                         BssrdfOptions options)
    : scene_((check(scene), scene)),
      albedo_(scene_),
      placement_(uv_from_surface(scene_)),
      bssrdf_(make_bssrdf(model, BssrdfMedium{&profile, scene_.medium.sigma_t(), &albedo_},
                          with_placement(options, placement_))) {}

SurfacePoint PlanarModel::surface(Vec2 p) const {
  SurfacePoint point;
  point.position = Vec3(p, 0);
  point.geometric_normal = point.shading_normal = Vec3(0, 0, 1);
  point.uv = scene_.uv(p);
  return point;
}

BssrdfPoint PlanarModel::exit(Vec2 p) const {
  BssrdfPoint result = point(p);
  if (!scene_.view.radiosity) result.towards_viewer = scene_.view.towards;
  return result;
}

PlanarSampling planar_sampling_from_name(std::string_view name) {
  if (name == "uniform") return PlanarSampling::uniform;
  if (name == "profile") return PlanarSampling::profile;
  if (name == "mis") return PlanarSampling::mis;
  if (name == "clipped") return PlanarSampling::clipped;
  throw InputError("sampling '" + std::string(name) + "' is not known; use uniform, profile, mis or clipped");
}

/// What one exit point makes of the two strategies.
struct PlanarIntegrator::Strategies {
  Vec2 exit{0};
  double profile_share = 1;      // probability of drawing by the profile
  int channels = 3;              // 1: all agree
  std::array<int, 3> level{};    // of the distance table, by channel
  LightDiskSampler::View light;  // clipped only
};

namespace {

constexpr double largest_below_one = 0x1.fffffffffffffp-1;
// Of the samples, by area: they bound the weights where the texture defeats the profile.
constexpr double area_share_of_clipped = 0.1;

double circumscribed_radius(const PlanarLight& light) {
  return light.shape == PlanarLight::Shape::square ? std::sqrt(2.0) * light.radius : light.radius;
}

// Half the angle under which the circle of this radius around a point `offset` away from the centre of a disk
// lies within the disk.
double half_angle(double distance, double offset, double reach) {
  if (offset + distance <= reach) return pi;
  const double cosine = (offset * offset + distance * distance - reach * reach) / (2 * offset * distance);
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

}  // namespace

PlanarIntegrator::PlanarIntegrator(const PlanarModel& model, PlanarSampling sampling)
    : model_(model),
      scene_(model.scene()),
      sampling_(scene_.light.shape == PlanarLight::Shape::plane ? PlanarSampling::profile : sampling),
      light_reach_(circumscribed_radius(scene_.light)) {
  const double eta = scene_.medium.eta;
  outgoing_ =
      scene_.view.radiosity ? diffuse_transmittance(eta) : 1 - fresnel_dielectric(scene_.view.towards.z, eta);
  if (sampling_ == PlanarSampling::mis) tabulate_profile_share();
  if (sampling_ == PlanarSampling::clipped) {
    const Rgb sigma_t = model_.bssrdf().medium().sigma_t;
    const int samplers = sigma_t.is_grey() ? 1 : 3;
    for (int c = 0; c < samplers; ++c)
      light_samplers_.emplace_back(model_.bssrdf().distances(), sigma_t[c], light_reach_);
  }
}

// Unconfined, the profile is worth choosing as often as it meets the light: its share of the samples is the
// probability that a distance from it, at a uniform angle, does. Any positive share would be unbiased.
void PlanarIntegrator::tabulate_profile_share() {
  const Rgb albedo = mean_albedo(*scene_.albedo);
  const DistanceTable& table = model_.bssrdf().distances();
  const int level = DistanceTable::level(albedo.mean());
  const double sigma_t = scene_.medium.sigma_t().mean();
  const double spacing = light_reach_ / 8;
  for (int i = 0; i < 64; ++i) {
    const double offset = i * spacing;
    const double nearest = std::max(0.0, offset - light_reach_), farthest = offset + light_reach_;
    constexpr int steps = 32;
    double hit = 0;
    for (int k = 0; k < steps; ++k) {
      const auto at = [&](double f) { return nearest + (farthest - nearest) * f / steps; };
      hit += (table.cdf(level, sigma_t * at(k + 1)) - table.cdf(level, sigma_t * at(k))) *
             half_angle(at(k + 0.5), offset, light_reach_) / pi;
    }
    profile_share_.push_back(std::clamp(hit, 0.0, 0.9));
  }
}

double PlanarIntegrator::profile_share(double offset) const {
  const double t = offset / light_reach_ * 8;
  const auto last = static_cast<double>(profile_share_.size() - 1);
  return profile_share_[static_cast<std::size_t>(std::min(t, last))];
}

PlanarIntegrator::Strategies PlanarIntegrator::strategies(const BssrdfPoint& exit) const {
  Strategies s;
  s.exit = Vec2(exit.surface.position);
  if (sampling_ == PlanarSampling::uniform) {
    s.profile_share = 0;
    return s;
  }
  const Rgb typical = model_.bssrdf().typical_albedo(exit);
  s.channels = typical.is_grey() && model_.bssrdf().medium().sigma_t.is_grey() ? 1 : 3;
  for (int c = 0; c < s.channels; ++c)
    s.level[static_cast<std::size_t>(c)] = DistanceTable::level(typical[c]);
  if (sampling_ == PlanarSampling::mis) {
    s.profile_share = profile_share(glm::length(s.exit - scene_.light.centre));
  } else if (sampling_ == PlanarSampling::clipped) {
    s.light = light_samplers_.front().view(scene_.light.centre - s.exit);
    s.profile_share = 1 - area_share_of_clipped;
    for (int c = 0; c < s.channels; ++c)
      if (light_sampler(c).is_even(s.light, s.level[static_cast<std::size_t>(c)])) s.profile_share = 0;
  }
  return s;
}

/// Draws an entry point and its density per m^2; nothing where it misses the light.
std::optional<PlanarIntegrator::Entry> PlanarIntegrator::draw(const Strategies& s, Vec2 u) const {
  // One pair of numbers decides everything, each decision passing on what is left of it: the samples stay
  // stratified.
  if (u.x >= s.profile_share) {
    const Vec2 p = scene_.light.sample({(u.x - s.profile_share) / (1 - s.profile_share), u.y});
    return with_pdf(s, p);
  }
  u.x = std::min(u.x / s.profile_share, largest_below_one);
  int c = 0;
  if (s.channels > 1) {
    c = std::min(static_cast<int>(u.x * s.channels), s.channels - 1);
    u.x = std::min(u.x * s.channels - c, largest_below_one);
  }
  const int level = s.level[static_cast<std::size_t>(c)];
  if (sampling_ == PlanarSampling::clipped) {
    const auto place = light_sampler(c).sample(s.light, level, u);
    if (!place) return std::nullopt;
    return with_pdf(s, s.exit + light_sampler(c).displacement(s.light, *place), *place);
  }
  const double sigma_t = model_.bssrdf().medium().sigma_t[c];
  const double distance = model_.bssrdf().distances().sample(level, u.x) / sigma_t,
               angle = pi * (2 * u.y - 1);
  return with_pdf(s, s.exit + distance * Vec2(std::cos(angle), std::sin(angle)));
}

std::optional<PlanarIntegrator::Entry> PlanarIntegrator::with_pdf(const Strategies& s, Vec2 entry) const {
  if (sampling_ == PlanarSampling::clipped && s.profile_share > 0) {
    const auto place = light_samplers_.front().place(s.light, entry - s.exit);
    if (!place) return std::nullopt;
    return with_pdf(s, entry, *place);
  }
  const double distance = glm::distance(entry, s.exit);
  if (!scene_.light.contains(entry) || !(distance > 0)) return std::nullopt;
  double by_profile = 0;
  if (s.profile_share > 0) {
    const Rgb sigma_t = model_.bssrdf().medium().sigma_t;
    for (int c = 0; c < s.channels; ++c)
      by_profile += sigma_t[c] * model_.bssrdf().distances().pdf(s.level[static_cast<std::size_t>(c)],
                                                                 sigma_t[c] * distance);
    by_profile /= s.channels * 2 * pi * distance;
  }
  return Entry{entry, mixture(s, by_profile)};
}

std::optional<PlanarIntegrator::Entry> PlanarIntegrator::with_pdf(
    const Strategies& s, Vec2 entry, const LightDiskSampler::Place& place) const {
  if (!scene_.light.contains(entry)) return std::nullopt;
  double by_profile = 0;
  for (int c = 0; c < s.channels; ++c)
    by_profile += light_sampler(c).pdf(s.light, s.level[static_cast<std::size_t>(c)], place);
  return Entry{entry, mixture(s, by_profile / s.channels)};
}

double PlanarIntegrator::mixture(const Strategies& s, double by_profile) const {
  const double by_area = s.profile_share < 1 ? (1 - s.profile_share) / scene_.light.area() : 0;
  return by_area + s.profile_share * by_profile;
}

Rgb PlanarIntegrator::radiance(const BssrdfPoint& exit, const Sampler& sampler) const {
  const Strategies s = strategies(exit);
  const auto entry = draw(s, sampler.get_2d(Dimension::entry_radius));
  if (!entry) return {};
  const Rgb s_v = model_.bssrdf().evaluate(model_.point(entry->point), exit);
  return scene_.light.radiance * s_v * (outgoing_ / entry->pdf);
}

PixelSample PlanarIntegrator::sample(int x, int y, const Sampler& sampler) const {
  const BssrdfPoint exit = model_.exit(scene_.view.point(Vec2(x, y) + sampler.get_2d(Dimension::pixel)));
  PixelSample result;
  result.radiance = radiance(exit, sampler);
  result.alpha = 1;
  result.albedo = exit.albedo;
  result.normal = exit.surface.shading_normal;
  result.hit = true;
  return result;
}

}  // namespace alabaster
