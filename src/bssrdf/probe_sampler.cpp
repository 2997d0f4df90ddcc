#include "bssrdf/probe_sampler.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "bssrdf/smoothed_normals.h"
#include "core/frame.h"
#include "optics/light_aim.h"

namespace alabaster {
namespace {

// The figures behind these choices stand in docs/probe_sampling.md.

/// Cosine between the axes and the normal.
constexpr double axis_cosine = 0.9;
/// The normal is that of the surface smoothed over so many of the longest mean free paths.
constexpr double facing_scale = 6;
/// Beyond its near part a chord is searched with this probability.
constexpr double far_probability = 0.1;
/// The near part reaches as far as this share of the radii, plus a multiple of the radius drawn.
constexpr double near_quantile = 0.9;
constexpr double near_radii = 2;
/// Of the draws, these go to the area strategy.
constexpr double area_share = 0.005;
/// Of the radii, this part follows the brightest albedo anywhere instead of the typical one around the exit.
constexpr double brightest_share = 0.05;

/// With the shape basis: width of the disk for light that crosses the body, in thicknesses; how far through
/// the body its probes always look; and the most of the draws that follow it, and the least worth the
/// trouble.
constexpr double body_width = 0.5;
constexpr double body_reach = 1.3;
constexpr double most_body_light = 0.85, least_body_light = 0.03;
/// Entries expected to be worth less than this part of all that leaves are followed more seldom.
constexpr double full_worth = 1;
/// With the shape basis one entry is chosen among the hits of two probes where the surface stands at more
/// than this (1 - cosine) to the way it faces on the whole, or where the albedo is that far (relatively) from
/// the one around.
constexpr double rough = 0.05;
constexpr double contrasting = 0.2;
/// So they are where the concentration of light's aim exceeds this.
constexpr double aimed_from = 0.1;

/// Takes one decision off a random number: the part of it below `probability`, stretched to [0, 1) again.
bool decide(double& u, double probability) {
  if (u < probability) {
    u /= probability;
    return true;
  }
  u = std::min((u - probability) / (1 - probability), 0x1.fffffffffffffp-1);
  return false;
}

double half_turned(double x) {
  return x < 0.5 ? x + 0.5 : x - 0.5;
}

/// Radii over a disk whose density falls as 1 / (1 + rho^2)^2 per area, up to a factor.
double disk_pdf(double rho) {
  const double spread = 1 + rho * rho;
  return 2 * rho / (spread * spread);
}
double disk_cdf(double rho) {
  return rho * rho / (1 + rho * rho);
}
double disk_radius(double u) {
  return std::sqrt(u / (1 - u));
}

/// Three directions at equal angles to a normal and to each other: none of them can miss a flat surface,
/// and a surface at a right angle to it, or at any other, is seen by one of them at least.
std::array<Vec3, 3> tilted_axes(const Vec3& normal) {
  const Frame frame(normal);
  const double aside = std::sqrt(1 - axis_cosine * axis_cosine);
  constexpr double half = 0.5, root = 0.86602540378443865;
  const Vec3 n = axis_cosine * normal;
  return {n + aside * frame.tangent, n + aside * (-half * frame.tangent + root * frame.bitangent),
          n + aside * (-half * frame.tangent - root * frame.bitangent)};
}

/// An albedo in 63 bits, to a few parts in 10^7; the last bit tells it from nothing.
uint64_t pack(const Rgb& albedo) {
  uint64_t bits = 1;
  for (int c = 0; c < 3; ++c)
    bits |= static_cast<uint64_t>(std::ceil(std::clamp(albedo[c], 0.0, 1.0) * 0x1fffff)) << (1 + 21 * c);
  return bits;
}
Rgb unpack(uint64_t bits) {
  Rgb albedo;
  for (int c = 0; c < 3; ++c)
    albedo[c] = static_cast<double>((bits >> (1 + 21 * c)) & 0x1fffff) * (1.0 / 0x1fffff);
  return albedo;
}

}  // namespace

/// Part of a line along an axis, m from where it passes the exit.
struct ProbeSampler::Part {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

ProbeSampler::Part ProbeSampler::near_part(const Exit& exit, double radius) {
  const double near = exit.near_limit + near_radii * radius;
  return {-near, near};
}

ProbeSampler::Part ProbeSampler::near_part(const Exit::Crossing& crossing, double radius) {
  return {-(crossing.near_limit + near_radii * radius), near_radii * radius};
}

/// An entry found, before S_V is evaluated.
struct ProbeSampler::Candidate {
  SurfacePoint surface;
  double density;
  Rgb albedo;
  PointShape shape;
  double importance = 1;  // about S_V / density
};

ProbeSampler::ProbeSampler(const Bssrdf& model, ProbeTarget target)
    : model_(model), target_(std::move(target)) {
  assert(target_.rays != nullptr && target_.mesh != nullptr);
  area_ = AreaSampler(*target_.mesh, [this](uint32_t triangle) { return in_medium(triangle); });
  centre_ = bounding_box(*target_.mesh).centre();
  for (const Vec3& p : target_.mesh->positions) radius_ = std::max(radius_, glm::distance(p, centre_));
  radius_ *= 1.0001;
  facing_ = smoothed_normals(*target_.mesh, facing_scale / model.medium().sigma_t.min());
  if (model.medium().shape != nullptr)
    body_light_.emplace(*model.medium().profile, *model.medium().shape->families);
  const Rgb brightest = model.medium().albedo->max();
  for (int c = 0; c < 3; ++c)
    brightest_level_[static_cast<std::size_t>(c)] = DistanceTable::level(brightest[c]);
  for (int level = 0; level < DistanceTable::level_count; ++level)
    near_distance_[static_cast<std::size_t>(level)] = model.distances().sample(level, near_quantile);
  if (model.typical_albedo_reach() > 0)
    typical_ = std::vector<std::atomic<uint64_t>>(target_.mesh->triangle_count());
}

bool ProbeSampler::in_medium(uint32_t triangle) const {
  return target_.material_in_medium.empty() ||
         target_.material_in_medium[target_.mesh->materials[triangle]] != 0;
}

// The value at the centre serves all of a small triangle. It is the same whoever asks first.
Rgb ProbeSampler::typical_albedo(const BssrdfPoint& exit) const {
  if (typical_.empty()) return model_.typical_albedo(exit);
  const uint32_t triangle = exit.surface.triangle;
  std::atomic<uint64_t>& slot = typical_[triangle];
  if (const uint64_t known = slot.load(std::memory_order_relaxed); known != 0)
    return known & 1 ? unpack(known) : model_.typical_albedo(exit);
  const TriangleMesh& mesh = *target_.mesh;
  const Index3& corners = mesh.corners[triangle];
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k)
    longest =
        std::max(longest, glm::distance(mesh.positions[corners[k]], mesh.positions[corners[(k + 1) % 3]]));
  constexpr uint64_t too_large = 2;
  if (longest > model_.typical_albedo_reach()) {
    slot.store(too_large, std::memory_order_relaxed);
    return model_.typical_albedo(exit);
  }
  BssrdfPoint centre;
  centre.surface = mesh.surface_point(triangle, Vec2(1.0 / 3));
  centre.surface.object = target_.object;
  centre.albedo = Rgb(1);  // black points among others must not make it black
  const uint64_t packed = pack(model_.typical_albedo(centre));
  slot.store(packed, std::memory_order_relaxed);
  return unpack(packed);
}

void ProbeSampler::fetch(uint32_t triangle) const {
  __builtin_prefetch(&facing_[triangle]);
  if (!typical_.empty()) __builtin_prefetch(&typical_[triangle]);
}

std::optional<ProbeSampler::Exit> ProbeSampler::prepare(const BssrdfPoint& point) const {
  const Rgb typical = typical_albedo(point);
  if (typical.is_black() || !(area_.area() > 0)) return std::nullopt;

  std::optional<Exit> result(std::in_place);
  Exit& exit = *result;
  exit.point = point;
  exit.typical = typical;
  if (body_light_)
    exit.shape =
        ShapeChannel(*model_.medium().shape->families, typical.mean(), model_.medium().sigma_t.mean());
  const Vec3 facing(facing_[point.surface.triangle]);
  const std::array<Vec3, 3> directions = tilted_axes(facing);
  for (std::size_t a = 0; a < 3; ++a) exit.axes[a] = axis(exit, directions[a]);
  add_components(exit);
  if (body_light_ && point.towards_viewer != Vec3(0)) {
    PairShape near;  // where aim is strong
    near.distance = 1 / model_.medium().sigma_t.mean();
    near.bend = std::sqrt(point.shape.bend_square);
    near.inverse_thickness = point.shape.inverse_thickness;
    exit.aimed = exit.shape.aim(near) > aimed_from;
  }
  exit.probes = exit.aimed || varied(exit, facing) ? 2 : 1;
  if (target_.light != nullptr) {
    const Vec3& position = point.surface.position;
    exit.mean_light = target_.light->mean(position);
    exit.usual_light = std::sqrt(target_.light->relative(position, facing, exit.mean_light));
  }
  return result;
}

bool ProbeSampler::varied(const Exit& exit, const Vec3& facing) const {
  if (!body_light_) return false;  // the half-space basis varies little beside what a probe costs
  if (1 - std::abs(glm::dot(exit.point.surface.geometric_normal, facing)) > rough) return true;
  if (typical_.empty()) return false;
  for (int c = 0; c < 3; ++c)
    if (std::abs(exit.point.albedo[c] - exit.typical[c]) > contrasting * exit.typical[c]) return true;
  return false;
}

ProbeSampler::Exit::Axis ProbeSampler::axis(const Exit& exit, const Vec3& direction) const {
  const Vec3 to_centre = centre_ - exit.point.surface.position;
  const Vec3 to_circle = to_centre - glm::dot(to_centre, direction) * direction;
  return {direction, to_circle, glm::length(to_circle)};
}

void ProbeSampler::add_components(Exit& exit) const {
  const Rgb &typical = exit.typical, &sigma_t = model_.medium().sigma_t;
  if (typical.is_grey() && sigma_t.is_grey()) {
    add_channel(exit, 0, 1);
  } else {
    const double sum = typical.r + typical.g + typical.b;
    for (int c = 0; c < 3; ++c)
      if (typical[c] > 0) add_channel(exit, c, typical[c] / sum);
  }
  const double farthest = glm::distance(centre_, exit.point.surface.position) + radius_;
  for (int k = 0; k < exit.component_count; ++k) {
    Exit::Component& c = exit.components[static_cast<std::size_t>(k)];
    c.reach = model_.distances().cdf(c.level, c.sigma_t * farthest);
    c.density_scale = c.probability * c.sigma_t / c.reach;
    c.profile_scale /= c.reach;
  }
  Exit::Crossing& crossing = exit.crossing;
  if (crossing.probability < least_body_light) crossing.probability = 0;
  if (crossing.probability == 0) return;
  const double thickness = 1 / exit.point.shape.inverse_thickness;
  const std::array<Vec3, 3> directions = tilted_axes(exit.point.shape.normal);
  for (std::size_t a = 0; a < 3; ++a) crossing.axes[a] = axis(exit, directions[a]);
  crossing.inverse_radius = 1 / (body_width * thickness);
  crossing.reach = disk_cdf(crossing.inverse_radius * farthest);
  crossing.near_limit = body_reach * thickness;
}

void ProbeSampler::add_channel(Exit& exit, int channel, double share) const {
  const double sigma = model_.medium().sigma_t[channel], albedo = exit.typical[channel];
  const auto add = [&](int level, double probability, double share_of_profile) {
    for (int k = 0; k < exit.component_count; ++k) {
      Exit::Component& other = exit.components[static_cast<std::size_t>(k)];
      if (other.level != level || other.sigma_t != sigma) continue;
      other.probability += probability;
      other.profile_scale += share_of_profile * sigma;
      return;
    }
    Exit::Component& fresh = exit.components[static_cast<std::size_t>(exit.component_count++)];
    fresh.level = level;
    fresh.sigma_t = sigma;
    fresh.probability = probability;
    fresh.profile_scale = share_of_profile * sigma;
  };
  const int level = DistanceTable::level(albedo);
  const int brightest = std::min(level, brightest_level_[static_cast<std::size_t>(channel)]);
  exit.near_limit = std::max(exit.near_limit, near_distance_[static_cast<std::size_t>(level)] / sigma);
  const PointShape& shape = exit.point.shape;
  if (body_light_ && shape.inverse_thickness > 0)
    exit.crossing.probability +=
        share * std::min(most_body_light,
                         body_light_->share(level, sigma / shape.inverse_thickness, shape.sphericity));
  add(level, (1 - brightest_share) * share, share);
  add(brightest, brightest_share * share, 0);
}

/// Density per metre of the radius around any of the tilted axes.
double ProbeSampler::radius_density(const Exit& exit, double radius) const {
  double sum = 0;
  for (int k = 0; k < exit.component_count; ++k) {
    const Exit::Component& c = exit.components[static_cast<std::size_t>(k)];
    sum += c.density_scale * model_.distances().pdf(c.level, c.sigma_t * radius);
  }
  return sum;
}

/// Half of the arc of that radius around the exit that lies within the object's circle.
double ProbeSampler::half_angle(const Exit::Axis& axis, double radius) const {
  if (radius + axis.centre <= radius_) return pi;
  const double cosine =
      (radius * radius + axis.centre * axis.centre - radius_ * radius_) / (2 * radius * axis.centre);
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

std::optional<Probe> ProbeSampler::choose(const Exit& exit, Vec2 choice, Vec2 disk) const {
  const bool far = choice.y < far_probability;
  const bool crosses = decide(choice.x, exit.crossing.probability);
  const auto a = std::min<std::size_t>(static_cast<std::size_t>(3 * choice.x), 2);
  if (crosses) {
    const Exit::Crossing& c = exit.crossing;
    const double radius = disk_radius(disk.x * c.reach) / c.inverse_radius;
    return chord(exit, c.axes[a], radius, disk.y, far ? Part{} : near_part(c, radius));
  }
  double u = 3 * choice.x - static_cast<double>(a);
  std::size_t k = 0;
  while (k + 1 < static_cast<std::size_t>(exit.component_count) && u >= exit.components[k].probability)
    u -= exit.components[k++].probability;
  const Exit::Component& c = exit.components[k];
  const double radius = model_.distances().sample(c.level, disk.x * c.reach) / c.sigma_t;
  return chord(exit, exit.axes[a], radius, disk.y, far ? Part{} : near_part(exit, radius));
}

std::optional<Probe> ProbeSampler::chord(const Exit& exit, const Exit::Axis& axis, double radius, double turn,
                                         const Part& part) const {
  const double half_arc = half_angle(axis, radius);
  if (!(half_arc > 0)) return std::nullopt;
  const double angle = half_arc * (2 * turn - 1);
  const Vec3 across =
      axis.centre > 1e-9 * radius_ ? axis.to_circle / axis.centre : Frame(axis.direction).tangent;
  const Vec3 aside = glm::cross(axis.direction, across);
  const Vec3 centre =
      exit.point.surface.position + radius * (std::cos(angle) * across + std::sin(angle) * aside);

  // The chord within the bounding sphere, then the part of it that is searched.
  const Vec3 to_sphere = centre_ - centre;
  const double middle = glm::dot(to_sphere, axis.direction);
  const double half_squared = radius_ * radius_ - (length_squared(to_sphere) - middle * middle);
  const double half = std::sqrt(std::max(half_squared, 0.0));
  const double low = std::max(middle - half, part.low), high = std::min(middle + half, part.high);
  if (!(low < high)) return std::nullopt;
  Probe probe;
  probe.ray.origin = centre + low * axis.direction;
  probe.ray.direction = axis.direction;
  probe.ray.t_max = high - low;
  return probe;
}

double ProbeSampler::density(const Exit& exit, const SurfacePoint& entry) const {
  const Vec3 offset = entry.position - exit.point.surface.position;
  const double square = length_squared(offset);
  // Of lines along an axis, per density of the radius.
  const auto lines = [&](const Exit::Axis& axis, double along, double radius, const Part& near) {
    const double searched = along >= near.low && along <= near.high ? 1 : far_probability;
    return searched * std::abs(glm::dot(entry.geometric_normal, axis.direction)) /
           (radius * 2 * half_angle(axis, radius));
  };
  const auto place = [&](const Exit::Axis& axis) {
    const double along = glm::dot(offset, axis.direction);
    return Vec2(along, std::max(std::sqrt(std::max(square - along * along, 0.0)), 1e-100));
  };
  double around = 0, across = 0;
  for (const Exit::Axis& axis : exit.axes) {
    const Vec2 p = place(axis);
    around += lines(axis, p.x, p.y, near_part(exit, p.y)) * radius_density(exit, p.y);
  }
  const Exit::Crossing& c = exit.crossing;
  for (std::size_t a = 0; c.probability > 0 && a < 3; ++a) {
    const Vec2 p = place(c.axes[a]);
    across += lines(c.axes[a], p.x, p.y, near_part(c, p.y)) * c.inverse_radius *
              disk_pdf(c.inverse_radius * p.y) / c.reach;
  }
  return area_share / area_.area() +
         (1 - area_share) * ((1 - c.probability) * around + c.probability * across) / 3;
}

void ProbeSampler::draw(const Exit& exit, const EntryRandom& u, std::vector<Candidate>& candidates) const {
  static thread_local std::vector<Hit> hits;
  const auto add = [&](uint32_t triangle, Vec2 barycentric) {
    if (!in_medium(triangle)) return;
    // Side by side, so that one waits for memory while the other does.
    const PointShape shape = model_.medium().shape_at(triangle, barycentric);
    const SurfacePoint surface = target_.mesh->surface_point(triangle, barycentric);
    const double distance = glm::distance(surface.position, exit.point.surface.position);
    if (!(distance > 0)) return;
    Candidate& candidate = candidates.emplace_back();
    candidate.surface = surface;
    candidate.surface.object = target_.object;
    candidate.density = density(exit, surface);
    candidate.albedo = model_.medium().albedo->at(candidate.surface);
    candidate.shape = shape;
    candidate.importance = importance(exit, candidate, distance);
  };
  Vec2 choice = u.choice;
  if (decide(choice.x, area_share)) {
    const auto [triangle, barycentric] = area_.sample(u.disk);
    add(triangle, barycentric);
  } else if (const std::optional<Probe> probe = choose(exit, choice, u.disk)) {
    target_.rays->all_hits(target_.object, probe->ray, hits);
    for (const Hit& hit : hits) add(hit.triangle, hit.barycentric);
  }
}

/// About S_V / density times the light, in units of what leaves where the light is as usual: by the density
/// of the radii, which costs a table lookup, and in one channel the factor of the shape, since the far side
/// of a body may send more light than the near side.
double ProbeSampler::importance(const Exit& exit, const Candidate& candidate, double distance) const {
  double profile = 0;
  for (int k = 0; k < exit.component_count; ++k) {
    const Exit::Component& c = exit.components[static_cast<std::size_t>(k)];
    if (c.profile_scale > 0)
      profile += c.profile_scale * model_.distances().pdf(c.level, c.sigma_t * distance);
  }
  double value = profile / (2 * pi * distance * candidate.density);
  if (body_light_) {
    const PairShape pair = model_.pair(candidate.surface.position, candidate.shape,
                                       exit.point.surface.position, exit.point.shape);
    value *= exit.shape.factor(pair);
    if (exit.aimed) value *= expected_aim(exit, candidate, pair);
  }
  value *= candidate.albedo.mean() / exit.typical.mean();
  if (target_.light != nullptr)
    value *= target_.light->relative(candidate.surface.position, candidate.surface.shading_normal,
                                     exit.mean_light) /
             exit.usual_light;
  return value;
}

double ProbeSampler::expected_aim(const Exit& exit, const Candidate& candidate, const PairShape& pair) const {
  const SurfacePoint &entry = candidate.surface, &left = exit.point.surface;
  const LightAim aim(Rgb(exit.shape.aim(pair)), entry.position, entry.shading_normal, left.position,
                     left.shading_normal, exit.point.towards_viewer);
  const Vec3 from =
      target_.light != nullptr ? target_.light->direction(entry.position, entry.shading_normal) : Vec3(0);
  return aim.at(from).r;
}

EntrySample ProbeSampler::finish(const Exit& exit, const Candidate& candidate, double factor) const {
  EntrySample entry;
  const SurfacePoint& surface = candidate.surface;
  entry.point = {surface, candidate.albedo, candidate.shape};
  entry.density = candidate.density;
  entry.weight = model_.evaluate(entry.point, exit.point) * (factor / candidate.density);
  return entry;
}

std::optional<EntrySample> ProbeSampler::sample_entry(const BssrdfPoint& point, const EntryRandom& u) const {
  const std::optional<Exit> exit = prepare(point);
  if (!exit) return std::nullopt;
  static thread_local std::vector<Candidate> candidates;
  candidates.clear();
  draw(*exit, u, candidates);
  // The second probe lies on the other side of the exit: what light's aim gives to the one it takes from the
  // other.
  if (exit->probes == 2) draw(*exit, {u.choice, Vec2(u.disk.x, half_turned(u.disk.y)), 0}, candidates);
  double sum = 0;
  for (const Candidate& c : candidates) sum += c.importance;
  const double worth = sum / exit->probes;
  if (!(sum > 0)) return std::nullopt;
  double left = u.pick * sum;
  std::size_t k = 0;
  while (k + 1 < candidates.size() && left >= candidates[k].importance) left -= candidates[k++].importance;
  // The less it should be worth, the more seldom it is worth evaluating S_V and the light there; the part of
  // the random number left over decides. Where nothing is known of the light, what comes through a body from
  // a lamp behind it may be worth more than it seems.
  const bool known = !body_light_ || target_.light != nullptr;
  const double survival = known ? std::min(1.0, worth / full_worth) : 1;
  if (survival < 1 && left >= survival * candidates[k].importance) return std::nullopt;
  return finish(*exit, candidates[k], worth / (candidates[k].importance * survival));
}

std::optional<EntrySample> ProbeSampler::sample_entry(const BssrdfPoint& exit, const Sampler& sampler,
                                                      uint32_t occurrence) const {
  EntryRandom u;
  u.choice = sampler.get_2d(Dimension::entry_strategy, occurrence);
  u.disk = sampler.get_2d(Dimension::entry_radius, occurrence);
  u.pick = sampler.get_1d(Dimension::entry_hit, occurrence);
  return sample_entry(exit, u);
}

std::size_t ProbeSampler::sample_entries(const BssrdfPoint& point, const EntryRandom& u,
                                         std::span<EntrySample> entries) const {
  const std::optional<Exit> exit = prepare(point);
  if (!exit || entries.empty()) return 0;
  static thread_local std::vector<Candidate> candidates;
  candidates.clear();
  draw(*exit, u, candidates);
  const std::size_t count = std::min(candidates.size(), entries.size());
  if (count == 0) return 0;
  // A run of `count` candidates that starts anywhere, wrapping around: each is in it equally often.
  const auto start = static_cast<std::size_t>(u.pick * static_cast<double>(candidates.size()));
  const double factor = static_cast<double>(candidates.size()) / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k)
    entries[k] = finish(*exit, candidates[(start + k) % candidates.size()], factor);
  return count;
}

}  // namespace alabaster
