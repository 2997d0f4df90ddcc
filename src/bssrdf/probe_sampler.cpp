#include "bssrdf/probe_sampler.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/frame.h"

namespace alabaster {
namespace {

/// Beyond its near part a chord is searched with this probability.
constexpr double far_probability = 0.25;
/// The near part reaches as far as this share of the radii, plus a multiple of the radius drawn.
constexpr double near_quantile = 0.9;
constexpr double near_radii = 2;

/// Takes one decision off a random number: the part of it below `probability`, stretched to [0, 1) again.
bool decide(double& u, double probability) {
  if (u < probability) {
    u /= probability;
    return true;
  }
  u = std::min((u - probability) / (1 - probability), 0x1.fffffffffffffp-1);
  return false;
}

/// Three perpendicular axes that stand at equal angles to the normal, so that none of them can miss a flat
/// surface and a surface at a right angle to it is seen as well.
std::array<Vec3, 3> tilted_axes(const Vec3& normal) {
  const Frame frame(normal);
  constexpr double along = 0.57735026918962576, aside = 0.81649658092772603;
  constexpr double half = 0.5, root = 0.86602540378443865;
  const Vec3 n = along * normal;
  return {n + aside * frame.tangent, n + aside * (-half * frame.tangent + root * frame.bitangent),
          n + aside * (-half * frame.tangent - root * frame.bitangent)};
}

}  // namespace

/// An entry found, before S_V is evaluated.
struct ProbeSampler::Candidate {
  uint32_t triangle;
  Vec2 barycentric;
  double density;
  double importance;  // about S_V / density
};

ProbeSampler::ProbeSampler(const Bssrdf& model, ProbeTarget target)
    : model_(model), target_(std::move(target)) {
  assert(target_.rays != nullptr && target_.mesh != nullptr);
  area_ = AreaSampler(*target_.mesh, [this](uint32_t triangle) { return in_medium(triangle); });
  centre_ = bounding_box(*target_.mesh).centre();
  for (const Vec3& p : target_.mesh->positions) radius_ = std::max(radius_, glm::distance(p, centre_));
  radius_ *= 1.0001;
}

bool ProbeSampler::in_medium(uint32_t triangle) const {
  return target_.material_in_medium.empty() ||
         target_.material_in_medium[target_.mesh->materials[triangle]] != 0;
}

std::optional<ProbeSampler::Exit> ProbeSampler::prepare(const BssrdfPoint& point) const {
  const Rgb typical = model_.typical_albedo(point);
  if (typical.is_black() || !(area_.area() > 0)) return std::nullopt;
  const Rgb brightest = model_.medium().albedo->max();
  const Rgb& sigma_t = model_.medium().sigma_t;
  const DistanceTable& table = model_.distances();

  Exit exit;
  exit.point = point;
  exit.axes = tilted_axes(point.surface.geometric_normal);
  exit.radius_limit = glm::distance(point.surface.position, centre_) + radius_;
  const auto add = [&](double albedo, double sigma, double share) {
    const int level = DistanceTable::level(albedo);
    for (int k = 0; k < exit.component_count; ++k) {
      Exit::Component& other = exit.components[static_cast<std::size_t>(k)];
      if (other.level == level && other.sigma_t == sigma) {
        other.probability += share;
        return;
      }
    }
    exit.components[static_cast<std::size_t>(exit.component_count++)] = {
        level, sigma, share, table.cdf(level, sigma * exit.radius_limit)};
  };
  const double sum = typical.r + typical.g + typical.b;
  for (int c = 0; c < 3; ++c) {
    if (!(typical[c] > 0)) continue;
    const double share = typical[c] / sum;
    add(typical[c], sigma_t[c], 0.75 * share);
    add(std::max(typical[c], brightest[c]), sigma_t[c], 0.25 * share);
    exit.near_limit =
        std::max(exit.near_limit, table.sample(DistanceTable::level(typical[c]), near_quantile) / sigma_t[c]);
  }
  const double spread = 2 * pi * exit.near_limit * exit.near_limit;
  exit.area_probability = 0.02 + 0.18 * std::min(1.0, spread / area_.area());
  return exit;
}

double ProbeSampler::radius_density(const Exit& exit, double radius) const {
  double sum = 0;
  for (int k = 0; k < exit.component_count; ++k) {
    const Exit::Component& c = exit.components[static_cast<std::size_t>(k)];
    sum += c.probability * c.sigma_t / c.reach * model_.distances().pdf(c.level, c.sigma_t * radius);
  }
  return sum;
}

std::optional<Probe> ProbeSampler::choose(const Exit& exit, Vec2 choice, Vec2 disk) const {
  const auto axis = std::min<std::size_t>(static_cast<std::size_t>(3 * choice.x), 2);
  double u = 3 * choice.x - static_cast<double>(axis);
  int k = 0;
  while (k + 1 < exit.component_count && u >= exit.components[static_cast<std::size_t>(k)].probability)
    u -= exit.components[static_cast<std::size_t>(k++)].probability;
  const Exit::Component& c = exit.components[static_cast<std::size_t>(k)];
  const double radius = model_.distances().sample(c.level, disk.x * c.reach) / c.sigma_t;
  const double angle = 2 * pi * disk.y;

  const Vec3& direction = exit.axes[axis];
  const Vec3& across = exit.axes[(axis + 1) % 3];
  const Vec3& aside = exit.axes[(axis + 2) % 3];
  const Vec3& x = exit.point.surface.position;
  const Vec3 centre = x + radius * (std::cos(angle) * across + std::sin(angle) * aside);

  // The chord within the bounding sphere, then its near part.
  const Vec3 to_sphere = centre_ - centre;
  const double middle = glm::dot(to_sphere, direction);
  const double half_squared = radius_ * radius_ - (length_squared(to_sphere) - middle * middle);
  if (!(half_squared > 0)) return std::nullopt;
  const double half = std::sqrt(half_squared);
  double low = middle - half, high = middle + half;
  if (choice.y >= far_probability) {
    const double near = exit.near_limit + near_radii * radius;
    low = std::max(low, -near);
    high = std::min(high, near);
    if (!(low < high)) return std::nullopt;
  }
  Probe probe;
  probe.ray.origin = centre + low * direction;
  probe.ray.direction = direction;
  probe.ray.t_max = high - low;
  return probe;
}

double ProbeSampler::density(const Exit& exit, const Vec3& position, const Vec3& normal) const {
  const Vec3 offset = position - exit.point.surface.position;
  double sum = 0;
  for (const Vec3& axis : exit.axes) {
    const double along = glm::dot(offset, axis);
    const double radius = std::max(glm::length(offset - along * axis), 1e-100);
    const bool near = std::abs(along) <= exit.near_limit + near_radii * radius;
    sum += (near ? 1 : far_probability) * std::abs(glm::dot(normal, axis)) * radius_density(exit, radius) /
           radius;
  }
  return exit.area_probability / area_.area() + (1 - exit.area_probability) * sum / (3 * 2 * pi);
}

double ProbeSampler::density(const Exit& exit, const SurfacePoint& entry) const {
  return density(exit, entry.position, entry.geometric_normal);
}

std::span<ProbeSampler::Candidate> ProbeSampler::draw(const Exit& exit, const EntryRandom& u) const {
  static thread_local std::vector<Hit> hits;
  static thread_local std::vector<Candidate> candidates;
  candidates.clear();
  const auto add = [&](uint32_t triangle, Vec2 barycentric) {
    if (!in_medium(triangle)) return;
    const TriangleMesh& mesh = *target_.mesh;
    const Vec3 position = mesh.position(triangle, barycentric);
    const double distance = glm::distance(position, exit.point.surface.position);
    if (!(distance > 0)) return;
    const double expected = density(exit, position, mesh.geometric_normal(triangle));
    candidates.push_back(
        {triangle, barycentric, expected, radius_density(exit, distance) / (distance * expected)});
  };
  Vec2 choice = u.choice;
  if (decide(choice.x, exit.area_probability)) {
    const auto [triangle, barycentric] = area_.sample(u.area);
    add(triangle, barycentric);
  } else if (const std::optional<Probe> probe = choose(exit, choice, u.disk)) {
    target_.rays->all_hits(target_.object, probe->ray, hits);
    for (const Hit& hit : hits) add(hit.triangle, hit.barycentric);
  }
  return candidates;
}

EntrySample ProbeSampler::finish(const Exit& exit, const Candidate& candidate, double factor) const {
  SurfacePoint surface = target_.mesh->surface_point(candidate.triangle, candidate.barycentric);
  surface.object = target_.object;
  EntrySample entry;
  entry.point = model_.medium().point(surface);
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
  return finish(*exit, candidates[k], sum / candidates[k].importance);
}

std::optional<EntrySample> ProbeSampler::sample_entry(const BssrdfPoint& exit, const Sampler& sampler,
                                                      uint32_t occurrence) const {
  EntryRandom u;
  u.choice = sampler.get_2d(Dimension::entry_strategy, occurrence);
  u.disk = sampler.get_2d(Dimension::entry_radius, occurrence);
  u.area = sampler.get_2d(Dimension::entry_area, occurrence);
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
