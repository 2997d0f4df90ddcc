#include "integrators/volume_walk.h"

#include <cmath>

#include "core/frame.h"
#include "optics/fresnel.h"
#include "optics/photon_walk.h"

namespace alabaster {

struct VolumeWalk::State {
  Vec3 position{0}, direction{0};
  uint32_t triangle = no_index;  // the boundary triangle the ray starts on; no_index at a collision
  Rgb weight{1};
  Rgb exit_albedo;
  int64_t order = 0;
  double clearance = 0;                                    // m: no boundary is closer to `position`
  double reach = std::numeric_limits<double>::infinity();  // m: some boundary is at most this close
  bool left = false;
  SurfacePoint end;
  int64_t queries = 0, rays = 0, lost = 0;
};

VolumeWalk::VolumeWalk(const RayScene& rays, const TriangleMesh& mesh, uint32_t object,
                       std::vector<uint8_t> boundary, const Medium& medium, const AlbedoField& albedo,
                       const VolumeWalkOptions& options)
    : rays_(rays),
      mesh_(mesh),
      object_(object),
      boundary_(std::move(boundary)),
      medium_(medium),
      sigma_t_(medium.sigma_t()),
      grey_(sigma_t_.is_grey()),
      albedo_(albedo),
      options_(options) {
  const BoundingBox box = bounding_box(mesh);
  slack_ = 0x1p-20 * std::max(glm::length(box.low), glm::length(box.high));
  if (options.albedo == WalkAlbedo::closest_point && options.closest_point == ClosestPointMode::cached)
    cells_ = std::make_unique<AlbedoCells>(rays, mesh, object, albedo, medium.mean_free_path.mean());
}

std::optional<VolumeWalkExit> VolumeWalk::walk(const SurfacePoint& start, const Vec3& direction,
                                               Rng& rng) const {
  State state;
  state.position = start.position;
  state.direction = direction;
  state.triangle = start.triangle;
  state.reach = 0;
  if (options_.albedo == WalkAlbedo::exit) state.exit_albedo = albedo_.at(start);
  while (advance(state, rng) && !state.left) {
  }
  counts_.collisions.fetch_add(state.order, std::memory_order_relaxed);
  counts_.queries.fetch_add(state.queries, std::memory_order_relaxed);
  counts_.rays.fetch_add(state.rays, std::memory_order_relaxed);
  counts_.lost.fetch_add(state.lost, std::memory_order_relaxed);
  counts_.walks.fetch_add(1, std::memory_order_relaxed);
  if (!state.left) return std::nullopt;
  return VolumeWalkExit{state.end, state.direction, state.weight, state.order};
}

namespace {

// Corrections of cached albedos may leave a weight negative.
Rgb magnitude(const Rgb& weight) {
  return {std::abs(weight.r), std::abs(weight.g), std::abs(weight.b)};
}

double largest_magnitude(const Rgb& weight) {
  return magnitude(weight).max();
}

// One channel's free flight, chosen in proportion to the weight each channel still carries.
int choose_channel(const Rgb& weight, Rng& rng) {
  const Rgb share = magnitude(weight);
  const double u = rng.uniform() * (share.r + share.g + share.b);
  return u < share.r ? 0 : u < share.r + share.g ? 1 : 2;
}

// What the weights become where the flight was drawn from the mixture of the channels' densities (balance
// heuristic): value_c / sum_k p_k density_k, p_k the weights' shares.
Rgb reweight(const Rgb& weight, const Rgb& value, const Rgb& density) {
  const Rgb share = magnitude(weight), shared = share * density;
  const double mixture = (shared.r + shared.g + shared.b) / (share.r + share.g + share.b);
  return mixture > 0 ? weight * value / mixture : Rgb();
}

Rgb attenuation(const Rgb& sigma_t, double distance) {
  return {std::exp(-sigma_t.r * distance), std::exp(-sigma_t.g * distance), std::exp(-sigma_t.b * distance)};
}

}  // namespace

bool VolumeWalk::advance(State& state, Rng& rng) const {
  const int channel = grey_ ? 0 : choose_channel(state.weight, rng);
  const double flight = sample_free_flight(rng) / sigma_t_[channel];
  std::optional<Hit> hit;
  if (flight >= state.clearance) {
    Ray ray{state.position, state.direction, 0, flight};
    if (state.triangle != no_index) ray.ignore_object = object_, ray.ignore_triangle = state.triangle;
    hit = rays_.nearest(ray);
    ++state.rays;
  }
  const double travelled = hit ? hit->t : flight;
  if (!grey_) {
    const Rgb passed = attenuation(sigma_t_, travelled);
    const Rgb density = hit ? passed : sigma_t_ * passed;
    state.weight = reweight(state.weight, density, density);
  }
  state.position += travelled * state.direction;
  state.clearance = std::max(0.0, state.clearance - travelled);
  state.reach += travelled;
  if (hit) return meet_boundary(state, *hit, rng);
  state.triangle = no_index;
  return collide(state, rng);
}

bool VolumeWalk::collide(State& state, Rng& rng) const {
  if (++state.order > options_.max_order) return ++state.lost, false;
  const auto albedo = this->albedo(state, rng);
  if (!albedo) return ++state.lost, false;
  state.weight *= *albedo;
  const double survival = largest_magnitude(state.weight) * 4;
  if (survival < 1) {
    if (rng.uniform() >= survival) return false;
    state.weight /= survival;
  }
  state.direction = scatter(state.direction, medium_.g, rng);
  return true;
}

std::optional<Rgb> VolumeWalk::albedo(State& state, Rng& rng) const {
  if (options_.albedo == WalkAlbedo::exit) return state.exit_albedo;
  if (!cells_) return exact_albedo(state, state.reach, no_index);
  const AlbedoCells::View cell = cells_->at(state.position);
  if (cell.exactness >= 1) return exact_albedo(state, std::min(state.reach, cell.reach), cell.triangle);
  if (rng.uniform() >= cell.exactness) {
    state.clearance = std::max(state.clearance, cell.clearance - slack_);
    state.reach = std::min(state.reach, cell.reach);
    return cell.albedo;
  }
  const auto exact = exact_albedo(state, std::min(state.reach, cell.reach), cell.triangle);
  if (!exact) return exact;
  return cell.albedo + (*exact - cell.albedo) / cell.exactness;
}

std::optional<Rgb> VolumeWalk::exact_albedo(State& state, double reach, uint32_t guess) const {
  const auto closest = rays_.closest_point(object_, state.position, reach + slack_, guess);
  ++state.queries;
  if (!closest) return std::nullopt;
  state.clearance = closest->distance - slack_;
  state.reach = closest->distance;
  SurfacePoint point;  // an albedo needs no more of it
  point.triangle = closest->triangle;
  point.barycentric = closest->barycentric;
  point.uv = mesh_.uv(closest->triangle, closest->barycentric);
  return albedo_.at(point);
}

bool VolumeWalk::meet_boundary(State& state, const Hit& hit, Rng& rng) const {
  if (hit.object != object_ || boundary_[mesh_.materials[hit.triangle]] == 0) return false;
  const SurfacePoint point = mesh_.surface_point(hit.triangle, hit.barycentric);
  const Vec3& normal = point.geometric_normal;
  const double cosine = glm::dot(state.direction, normal);
  if (cosine <= 0) return ++state.lost, false;  // met from outside: slipped through a crack
  state.position = point.position;
  state.triangle = hit.triangle;
  state.clearance = 0;
  state.reach = 0;
  if (reflected_inside(cosine, medium_.eta, rng)) {
    state.direction -= 2 * cosine * normal;
    return true;
  }
  // Snell's law, out of the denser side.
  const Vec3 along = medium_.eta * (state.direction - cosine * normal);
  state.direction = glm::normalize(along + std::sqrt(std::max(0.0, 1 - glm::dot(along, along))) * normal);
  state.left = true;
  state.end = point;
  state.end.object = object_;
  return true;
}

}  // namespace alabaster
