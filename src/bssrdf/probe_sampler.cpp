#include "bssrdf/probe_sampler.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "bssrdf/smoothed_normals.h"
#include "core/frame.h"

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
/// the body probes always look; and the most of the radii that follow it.
constexpr double body_width = 0.5;
constexpr double body_reach = 1.3;
constexpr double most_body_light = 0.85;
/// Entries expected to be worth less than this part of all that leaves are followed more seldom.
constexpr double full_worth = 1;

/// Takes one decision off a random number: the part of it below `probability`, stretched to [0, 1) again.
bool decide(double& u, double probability) {
  if (u < probability) {
    u /= probability;
    return true;
  }
  u = std::min((u - probability) / (1 - probability), 0x1.fffffffffffffp-1);
  return false;
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

/// An entry found, before S_V is evaluated.
struct ProbeSampler::Candidate {
  SurfacePoint surface;
  double density;
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

std::optional<ProbeSampler::Exit> ProbeSampler::prepare(const BssrdfPoint& point) const {
  const Rgb typical = typical_albedo(point);
  if (typical.is_black() || !(area_.area() > 0)) return std::nullopt;

  std::optional<Exit> result(std::in_place);
  Exit& exit = *result;
  exit.point = point;
  const Vec3 to_centre = centre_ - point.surface.position;
  exit.typical = typical;
  const double body_share = add_components(exit, typical);
  // Light that crosses a body comes from straight behind, whatever the surroundings face.
  Vec3 facing(facing_[point.surface.triangle]);
  if (body_share > 0) {
    const double own = std::min(1.0, 4 * body_share);
    facing = glm::normalize((1 - own) * facing + (own + 1e-9) * point.shape.normal);
  }
  const std::array<Vec3, 3> directions = tilted_axes(facing);
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 to_circle = to_centre - glm::dot(to_centre, directions[a]) * directions[a];
    exit.axes[a] = {directions[a], to_circle, glm::length(to_circle)};
  }
  const double farthest = glm::length(to_centre) + radius_;
  for (int k = 0; k < exit.component_count; ++k) {
    Exit::Component& c = exit.components[static_cast<std::size_t>(k)];
    c.reach = component_cdf(c, farthest);
    c.density_scale = c.probability * c.sigma_t / c.reach;
  }
  return result;
}

double ProbeSampler::add_components(Exit& exit, const Rgb& typical) const {
  const Rgb& sigma_t = model_.medium().sigma_t;
  const auto add = [&](int level, double sigma, double share) {
    for (int k = 0; k < exit.component_count; ++k) {
      Exit::Component& other = exit.components[static_cast<std::size_t>(k)];
      if (other.level == level && other.sigma_t == sigma) {
        other.probability += share;
        return;
      }
    }
    Exit::Component& fresh = exit.components[static_cast<std::size_t>(exit.component_count++)];
    fresh.level = level;
    fresh.sigma_t = sigma;
    fresh.probability = share;
  };
  const auto add_channel = [&](int c, double share) {
    const int level = DistanceTable::level(typical[c]);
    add(level, sigma_t[c], (1 - brightest_share) * share);
    add(std::min(level, brightest_level_[static_cast<std::size_t>(c)]), sigma_t[c], brightest_share * share);
    exit.near_limit = std::max(exit.near_limit, near_distance_[static_cast<std::size_t>(level)] / sigma_t[c]);
  };
  // Light that crosses the body, if it is thin enough; one disk serves all channels.
  const PointShape& shape = exit.point.shape;
  double body_share = 0;
  const auto add_both = [&](int c, double share) {
    double body = 0;
    if (body_light_ && shape.inverse_thickness > 0)
      body = std::min(most_body_light,
                      body_light_->share(DistanceTable::level(typical[c]),
                                         sigma_t[c] / shape.inverse_thickness, shape.sphericity));
    add_channel(c, share * (1 - body));
    body_share += share * body;
  };
  if (typical.is_grey() && sigma_t.is_grey()) {
    add_both(0, 1);
  } else {
    const double sum = typical.r + typical.g + typical.b;
    for (int c = 0; c < 3; ++c)
      if (typical[c] > 0) add_both(c, typical[c] / sum);
  }
  if (body_share > 0) add_body_light(exit, body_share);
  return body_share;
}

void ProbeSampler::add_body_light(Exit& exit, double share) const {
  const double thickness = 1 / exit.point.shape.inverse_thickness;
  Exit::Component& disk = exit.components[static_cast<std::size_t>(exit.component_count++)];
  disk.level = -1;
  disk.sigma_t = 1 / (body_width * thickness);
  disk.probability = share;
  exit.near_limit = std::max(exit.near_limit, body_reach * thickness);
}

// The next three in units of 1 / sigma_t.
double ProbeSampler::component_pdf(const Exit::Component& c, double radius) const {
  const double rho = c.sigma_t * radius;
  return c.level < 0 ? 2 * rho / ((1 + rho * rho) * (1 + rho * rho)) : model_.distances().pdf(c.level, rho);
}

double ProbeSampler::component_cdf(const Exit::Component& c, double radius) const {
  const double rho = c.sigma_t * radius;
  return c.level < 0 ? rho * rho / (1 + rho * rho) : model_.distances().cdf(c.level, rho);
}

double ProbeSampler::component_radius(const Exit::Component& c, double u) const {
  return c.level < 0 ? std::sqrt(u / (1 - u)) : model_.distances().sample(c.level, u);
}

/// Density per metre of the radius around any axis.
double ProbeSampler::radius_density(const Exit& exit, double radius) const {
  double sum = 0;
  for (int k = 0; k < exit.component_count; ++k) {
    const Exit::Component& c = exit.components[static_cast<std::size_t>(k)];
    sum += c.density_scale * component_pdf(c, radius);
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
  const auto a = std::min<std::size_t>(static_cast<std::size_t>(3 * choice.x), 2);
  const Exit::Axis& axis = exit.axes[a];
  double u = 3 * choice.x - static_cast<double>(a);
  std::size_t k = 0;
  while (k + 1 < static_cast<std::size_t>(exit.component_count) && u >= exit.components[k].probability)
    u -= exit.components[k++].probability;
  const Exit::Component& c = exit.components[k];
  const double radius = component_radius(c, disk.x * c.reach) / c.sigma_t;
  const double half_arc = half_angle(axis, radius);
  if (!(half_arc > 0)) return std::nullopt;
  const double angle = half_arc * (2 * disk.y - 1);
  const Vec3 across =
      axis.centre > 1e-9 * radius_ ? axis.to_circle / axis.centre : Frame(axis.direction).tangent;
  const Vec3 aside = glm::cross(axis.direction, across);
  const Vec3 centre =
      exit.point.surface.position + radius * (std::cos(angle) * across + std::sin(angle) * aside);

  // The chord within the bounding sphere, then its near part.
  const Vec3 to_sphere = centre_ - centre;
  const double middle = glm::dot(to_sphere, axis.direction);
  const double half_squared = radius_ * radius_ - (length_squared(to_sphere) - middle * middle);
  const double half = std::sqrt(std::max(half_squared, 0.0));
  double low = middle - half, high = middle + half;
  if (choice.y >= far_probability) {
    const double near = exit.near_limit + near_radii * radius;
    low = std::max(low, -near);
    high = std::min(high, near);
  }
  if (!(low < high)) return std::nullopt;
  Probe probe;
  probe.ray.origin = centre + low * axis.direction;
  probe.ray.direction = axis.direction;
  probe.ray.t_max = high - low;
  return probe;
}

double ProbeSampler::density(const Exit& exit, const SurfacePoint& entry) const {
  const Vec3 offset = entry.position - exit.point.surface.position;
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const Exit::Axis& axis = exit.axes[a];
    const double along = glm::dot(offset, axis.direction);
    const double radius = std::max(glm::length(offset - along * axis.direction), 1e-100);
    const bool near = std::abs(along) <= exit.near_limit + near_radii * radius;
    sum += (near ? 1 : far_probability) * std::abs(glm::dot(entry.geometric_normal, axis.direction)) *
           radius_density(exit, radius) / (radius * 2 * half_angle(axis, radius));
  }
  return area_share / area_.area() + (1 - area_share) * sum / 3;
}

std::span<ProbeSampler::Candidate> ProbeSampler::draw(const Exit& exit, const EntryRandom& u) const {
  static thread_local std::vector<Hit> hits;
  static thread_local std::vector<Candidate> candidates;
  candidates.clear();
  const auto add = [&](uint32_t triangle, Vec2 barycentric) {
    if (!in_medium(triangle)) return;
    const SurfacePoint surface = target_.mesh->surface_point(triangle, barycentric);
    const double distance = glm::distance(surface.position, exit.point.surface.position);
    if (!(distance > 0)) return;
    Candidate& candidate = candidates.emplace_back();
    candidate.surface = surface;
    candidate.surface.object = target_.object;
    candidate.density = density(exit, surface);
    candidate.shape = model_.medium().shape_at(triangle, barycentric);
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
  return candidates;
}

/// About S_V / density: without the shape basis by the density of the radii, which costs a table lookup; with
/// it by the basis itself, since the far side of a body may send more light than the near side.
double ProbeSampler::importance(const Exit& exit, const Candidate& candidate, double distance) const {
  if (!body_light_) return radius_density(exit, distance) / (distance * candidate.density);
  const PairShape pair =
      model_.pair(candidate.surface.position, candidate.shape, exit.point.surface.position, exit.point.shape);
  return model_.basis_over_albedo(exit.typical, pair).mean() / candidate.density;
}

EntrySample ProbeSampler::finish(const Exit& exit, const Candidate& candidate, double factor) const {
  EntrySample entry;
  const SurfacePoint& surface = candidate.surface;
  entry.point = {surface, model_.medium().albedo->at(surface), candidate.shape};
  entry.density = candidate.density;
  entry.weight = model_.evaluate(entry.point, exit.point) * (factor / candidate.density);
  return entry;
}

std::optional<EntrySample> ProbeSampler::sample_entry(const BssrdfPoint& point, const EntryRandom& u) const {
  const std::optional<Exit> exit = prepare(point);
  if (!exit) return std::nullopt;
  const std::span<Candidate> candidates = draw(*exit, u);
  double sum = 0;
  for (const Candidate& c : candidates) sum += c.importance;
  if (!(sum > 0)) return std::nullopt;
  // The far-part decision left choice.y uniform on either side of far_probability.
  double rest = u.choice.y;
  decide(rest, far_probability);
  double left = rest * sum;
  std::size_t k = 0;
  while (k + 1 < candidates.size() && left >= candidates[k].importance) left -= candidates[k++].importance;
  // What it should be worth, in units of what leaves under uniform light. The less it is, the more seldom it
  // is worth evaluating S_V and the light there; the part of the random number left over decides.
  const double worth = body_light_ ? full_worth : sum / (2 * pi);
  const double survival = std::min(1.0, worth / full_worth);
  if (survival < 1 && left >= survival * candidates[k].importance) return std::nullopt;
  return finish(*exit, candidates[k], sum / (candidates[k].importance * survival));
}

std::optional<EntrySample> ProbeSampler::sample_entry(const BssrdfPoint& exit, const Sampler& sampler,
                                                      uint32_t occurrence) const {
  EntryRandom u;
  u.choice = sampler.get_2d(Dimension::entry_strategy, occurrence);
  u.disk = sampler.get_2d(Dimension::entry_radius, occurrence);
  return sample_entry(exit, u);
}

std::size_t ProbeSampler::sample_entries(const BssrdfPoint& point, const EntryRandom& u,
                                         std::span<EntrySample> entries) const {
  const std::optional<Exit> exit = prepare(point);
  if (!exit || entries.empty()) return 0;
  const std::span<Candidate> candidates = draw(*exit, u);
  const std::size_t count = std::min(candidates.size(), entries.size());
  if (count == 0) return 0;
  // A run of `count` candidates that starts anywhere, wrapping around: each is in it equally often.
  double rest = u.choice.y;
  decide(rest, far_probability);
  const auto start = static_cast<std::size_t>(rest * static_cast<double>(candidates.size()));
  const double factor = static_cast<double>(candidates.size()) / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k)
    entries[k] = finish(*exit, candidates[(start + k) % candidates.size()], factor);
  return count;
}

}  // namespace alabaster
