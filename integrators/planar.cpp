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
      square_texels_(std::abs(scene.tile.x * scene.albedo->height - scene.tile.y * scene.albedo->width) <
                     1e-9 * scene.tile.x * scene.albedo->height),
      texels_per_metre_(scene.albedo->width / scene.tile.x) {}

Rgb PlanarAlbedo::filtered(const KernelFootprint& footprint) const {
  if (square_texels_) return pyramid_.filtered(footprint.uv, footprint.sigma * texels_per_metre_);
  const Mat2 texels_from_uv(pyramid_.width(), 0, 0, pyramid_.height());
  const Mat2 j = footprint.sigma * texels_from_uv * footprint.uv_from_surface;
  return pyramid_.filtered(footprint.uv, j * glm::transpose(j));
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
  double profile_share = 1;  // probability of drawing by the profile
  // The disk around the light, as the exit sees it.
  bool clipped = false;
  Vec2 towards_light{1, 0};  // unit
  double offset = 0;         // m, from the exit to its centre
  double reach = 0;          // m, its radius

  int channels = 3;  // 1: all agree
  struct Channel {
    int level = 0;                 // of the distance table
    double sigma_t = 1;            // 1/m
    double below = 0, inside = 1;  // share of the distances nearer than the light, and at those of the light
  };
  std::array<Channel, 3> channel;

  /// Half the angle under which the circle of this radius around the exit lies within the light's disk.
  double half_angle(double distance) const {
    if (!clipped || offset + distance <= reach) return pi;
    const double cosine = (offset * offset + distance * distance - reach * reach) / (2 * offset * distance);
    return std::acos(std::clamp(cosine, -1.0, 1.0));
  }
};

namespace {

// Below this share of distances the table's differences are mostly rounding.
constexpr double smallest_share = 1e-6;
constexpr double infinite_contrast = 1e300;

double circumscribed_radius(const PlanarLight& light) {
  return light.shape == PlanarLight::Shape::square ? std::sqrt(2.0) * light.radius : light.radius;
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
    Strategies s;
    s.clipped = true;
    s.offset = i * spacing;
    s.reach = light_reach_;
    const double nearest = std::max(0.0, s.offset - s.reach), farthest = s.offset + s.reach;
    constexpr int steps = 32;
    double hit = 0;
    for (int k = 0; k < steps; ++k) {
      const auto at = [&](double f) { return nearest + (farthest - nearest) * f / steps; };
      hit += (table.cdf(level, sigma_t * at(k + 1)) - table.cdf(level, sigma_t * at(k))) *
             s.half_angle(at(k + 0.5)) / pi;
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
  const Rgb sigma_t = model_.bssrdf().medium().sigma_t;
  const Rgb typical = model_.bssrdf().typical_albedo(exit);
  s.channels = typical.is_grey() && sigma_t.is_grey() ? 1 : 3;
  for (int c = 0; c < s.channels; ++c) {
    s.channel[static_cast<std::size_t>(c)].level = DistanceTable::level(typical[c]);
    s.channel[static_cast<std::size_t>(c)].sigma_t = sigma_t[c];
  }
  if (sampling_ == PlanarSampling::mis) {
    s.profile_share = profile_share(glm::length(s.exit - scene_.light.centre));
  } else if (sampling_ == PlanarSampling::clipped) {
    clip_to_light(s);
  }
  return s;
}

void PlanarIntegrator::clip_to_light(Strategies& s) const {
  s.clipped = true;
  s.reach = light_reach_;
  const Vec2 offset = scene_.light.centre - s.exit;
  s.offset = glm::length(offset);
  if (s.offset > 0) s.towards_light = offset / s.offset;
  const DistanceTable& table = model_.bssrdf().distances();
  // From afar the profile varies little over the light, and its area alone is sampled more evenly than by two
  // strategies: measured on points, up to a hundredfold difference between its nearest
  // and farthest point.
  const double nearest = std::max(0.0, s.offset - s.reach), farthest = s.offset + s.reach;
  double smallest = 1, contrast = s.offset < 1.3 * s.reach ? infinite_contrast : 1;
  for (int c = 0; c < s.channels; ++c) {
    auto& channel = s.channel[static_cast<std::size_t>(c)];
    if (nearest > 0)
      contrast = std::max(contrast, table.pdf(channel.level, nearest * channel.sigma_t) * farthest /
                                        (table.pdf(channel.level, farthest * channel.sigma_t) * nearest));
    channel.below = table.cdf(channel.level, nearest * channel.sigma_t);
    channel.inside = table.cdf(channel.level, farthest * channel.sigma_t) - channel.below;
    smallest = std::min(smallest, channel.inside);
  }
  s.profile_share = smallest < smallest_share || contrast < 100 ? 0 : 0.75;
}

Vec2 PlanarIntegrator::draw(const Strategies& s, Vec2 u) const {
  // One pair of numbers decides everything, each decision passing on what is left of it: the samples stay
  // stratified.
  if (u.x >= s.profile_share) {
    return scene_.light.sample({(u.x - s.profile_share) / (1 - s.profile_share), u.y});
  }
  u.x /= s.profile_share;
  int c = 0;
  if (s.channels > 1) {
    c = std::min(static_cast<int>(u.x * s.channels), s.channels - 1);
    u.x = u.x * s.channels - c;
  }
  const auto& channel = s.channel[static_cast<std::size_t>(c)];
  const double position = channel.below + std::min(u.x, 0x1.fffffffffffffp-1) * channel.inside;
  const double distance = model_.bssrdf().distances().sample(channel.level, position) / channel.sigma_t;
  const double angle = s.half_angle(distance) * (2 * u.y - 1);
  const Vec2 side(-s.towards_light.y, s.towards_light.x);
  return s.exit + distance * (std::cos(angle) * s.towards_light + std::sin(angle) * side);
}

/// Per m^2, at a point within the light.
double PlanarIntegrator::pdf(const Strategies& s, double distance) const {
  double result = 0;
  if (s.profile_share < 1) result += (1 - s.profile_share) / scene_.light.area();
  if (s.profile_share > 0) {
    double by_distance = 0;
    for (int c = 0; c < s.channels; ++c) {
      const auto& channel = s.channel[static_cast<std::size_t>(c)];
      by_distance += channel.sigma_t / channel.inside *
                     model_.bssrdf().distances().pdf(channel.level, distance * channel.sigma_t);
    }
    result += s.profile_share * by_distance / (s.channels * 2 * s.half_angle(distance) * distance);
  }
  return result;
}

Rgb PlanarIntegrator::radiance(const BssrdfPoint& exit, const Sampler& sampler) const {
  const Strategies s = strategies(exit);
  const Vec2 entry = draw(s, sampler.get_2d(Dimension::entry_radius));
  const double distance = glm::length(entry - s.exit);
  if (!scene_.light.contains(entry) || !(distance > 0)) return {};
  const Rgb s_v = model_.bssrdf().evaluate(model_.point(entry), exit);
  return scene_.light.radiance * s_v * (outgoing_ / pdf(s, distance));
}

PixelSample PlanarIntegrator::sample(int x, int y, const Sampler& sampler) const {
  const BssrdfPoint exit = model_.point(scene_.view.point(Vec2(x, y) + sampler.get_2d(Dimension::pixel)));
  PixelSample result;
  result.radiance = radiance(exit, sampler);
  result.alpha = 1;
  result.albedo = exit.albedo;
  result.normal = exit.surface.shading_normal;
  result.hit = true;
  return result;
}

}  // namespace alabaster
