#include <algorithm>
#include <limits>

#include "integrators/volume_walk_state.h"
#include "optics/fresnel.h"
#include "optics/photon_walk.h"

namespace alabaster {

namespace {

// Walks that carry less than this are ended by Russian roulette.
constexpr double least_weight = 0.25;
// Steered ones: less than this share of what is typical, weighed by the importance of their depth.
constexpr double least_share = 0.5;
// Points at which the texture is read to learn how dark it is.
constexpr int darkness_samples = 1024;

double darkness(const Rgb& albedo) {
  return (DepthGuides::darkness(albedo.r) + DepthGuides::darkness(albedo.g) +
          DepthGuides::darkness(albedo.b)) /
         3;
}

}  // namespace

VolumeWalk::VolumeWalk(const RayScene& rays, const TriangleMesh& mesh, uint32_t object,
                       std::vector<uint8_t> boundary, const Medium& medium, const AlbedoField& albedo,
                       const VolumeWalkOptions& options, const LightGuide* guide, const AlbedoField* density)
    : rays_(rays),
      mesh_(mesh),
      object_(object),
      boundary_(std::move(boundary)),
      medium_(medium),
      sigma_t_(medium.sigma_t()),
      grey_(sigma_t_.is_grey()),
      albedo_(albedo),
      options_(options),
      guide_(options.look_for_light && density == nullptr ? guide : nullptr),
      density_(density) {
  const BoundingBox box = bounding_box(mesh);
  slack_ = 0x1p-20 * std::max(glm::length(box.low), glm::length(box.high));
  // With the exit's albedo the cells tell where the surface is, for the guide.
  const bool reads_texture = options.albedo == WalkAlbedo::closest_point;
  if (density != nullptr) return;  // every collision asks exactly
  if (options.closest_point == ClosestPointMode::cached && (reads_texture || guide_ != nullptr))
    cells_ = std::make_unique<AlbedoCells>(rays, mesh, object, reads_texture ? &albedo : nullptr,
                                           medium.mean_free_path.mean());
  else if (!reads_texture)
    guide_ = nullptr;
  // Where nothing else needs cells they would cost more than steering gains.
  if (options.steered && (reads_texture || cells_)) prepare_guides();
}

void VolumeWalk::prepare_guides() {
  double area = 0, volume = 0;
  std::vector<double> areas_up_to;
  for (uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    const Index3& corner = mesh_.corners[t];
    areas_up_to.push_back(area += mesh_.area(t));
    volume += glm::dot(mesh_.positions[corner[0]],
                       glm::cross(mesh_.positions[corner[1]], mesh_.positions[corner[2]])) /
              6;
  }
  const double radius = options_.open_sheets ? std::numeric_limits<double>::infinity()
                                             : 3 * std::abs(volume) / area * sigma_t_.mean();
  depth_guides_.emplace(medium_.g, radius);
  for (int k = 0; k < darkness_samples; ++k) {
    const double u = (k + 0.5) / darkness_samples * area;
    const auto found = std::upper_bound(areas_up_to.begin(), areas_up_to.end() - 1, u);
    const auto triangle = static_cast<uint32_t>(found - areas_up_to.begin());
    darkness_ += darkness(albedo_.at(mesh_.surface_point(triangle, Vec2(1.0 / 3)))) / darkness_samples;
  }
}

const DepthGuides::Column* VolumeWalk::choose_guides(const State& state) const {
  if (!depth_guides_) return nullptr;
  return &depth_guides_->column(options_.albedo == WalkAlbedo::exit ? darkness(state.exit_albedo)
                                                                    : darkness_);
}

std::optional<VolumeWalkExit> VolumeWalk::walk(const SurfacePoint& start, const Vec3& direction,
                                               Rng& rng) const {
  State state;
  state.position = start.position;
  state.direction = direction;
  state.triangle = start.triangle;
  state.reach = 0;
  if (options_.albedo == WalkAlbedo::exit) state.exit_albedo = albedo_.at(start);
  state.guides = choose_guides(state);
  begin_flight(state, start.geometric_normal, rng);
  while (advance(state, rng) && !state.left) {
  }
  std::optional<VolumeWalkExit> result;
  if (guide_ != nullptr)
    result = choose_exit(state, rng);
  else if (state.left)
    result = VolumeWalkExit{state.end, state.direction, state.weight, state.order};
  counts_.collisions.fetch_add(state.order, std::memory_order_relaxed);
  counts_.queries.fetch_add(state.queries, std::memory_order_relaxed);
  counts_.rays.fetch_add(state.rays, std::memory_order_relaxed);
  counts_.lost.fetch_add(state.lost, std::memory_order_relaxed);
  counts_.walks.fetch_add(1, std::memory_order_relaxed);
  return result;
}

namespace {

// One channel's free flight, chosen in proportion to the weight each channel still carries.
int choose_channel(const Rgb& weight, Rng& rng) {
  const Rgb share = magnitude(weight);
  const double u = rng.uniform() * (share.r + share.g + share.b);
  return u < share.r ? 0 : u < share.r + share.g ? 1 : 2;
}

}  // namespace

bool VolumeWalk::advance(State& state, Rng& rng) const {
  const int channel = grey_ ? 0 : choose_channel(state.weight, rng);
  const double rate = sigma_t_[channel] * (state.flight.steered ? state.flight.stretch : 1);
  const double flight = sample_free_flight(rng) / rate;
  std::optional<Hit> hit;
  if (flight >= state.clearance) {
    Ray ray{state.position, state.direction, 0, flight};
    if (state.triangle != no_index) ray.ignore_object = object_, ray.ignore_triangle = state.triangle;
    hit = rays_.nearest(ray);
    ++state.rays;
  }
  const double travelled = hit ? std::max(0.0, hit->t) : flight;
  weigh_flight(state, travelled, !hit);
  state.position += travelled * state.direction;
  state.clearance = std::max(0.0, state.clearance - travelled);
  state.reach += travelled;
  if (hit) return meet_boundary(state, *hit, rng);
  state.triangle = no_index;
  return collide(state, rng);
}

// Balance heuristic over the channels' flights, steered and plain.
void VolumeWalk::weigh_flight(State& state, double travelled, bool collides) const {
  if (grey_) {
    if (state.guide != nullptr) state.weight /= state.flight.density(sigma_t_.r * travelled, collides);
    return;
  }
  const Rgb passed = attenuation(sigma_t_, travelled);
  const Rgb value = collides ? sigma_t_ * passed : passed;
  const double drawn =
      mixture(state.weight,
              state.guide == nullptr ? value : value * steered_density(state.flight, travelled, collides));
  state.weight = drawn > 0 ? state.weight * value / drawn : Rgb();
}

Rgb VolumeWalk::steered_density(const SteeredFlight& flight, double travelled, bool collides) const {
  if (grey_) return Rgb(flight.density(sigma_t_.r * travelled, collides));
  Rgb density;
  for (int c = 0; c < 3; ++c) density[c] = flight.density(sigma_t_[c] * travelled, collides);
  return density;
}

// Along a direction that was not drawn.
void VolumeWalk::begin_flight(State& state, const Vec3& normal, Rng& rng) const {
  state.flight = {};
  if (state.guides == nullptr) return;
  state.guide = state.guides->at(0).guide;
  if (state.guide == nullptr) return;
  state.flight.steered = rng.uniform() < SteeredFlight::share;
  state.flight.stretch = 1 - state.guide->kappa() * glm::dot(state.direction, normal);
}

void VolumeWalk::scatter(State& state, Rng& rng) const {
  if (state.guide == nullptr) {
    state.flight = {};
    state.direction = alabaster::scatter(state.direction, medium_.g, rng);
    return;
  }
  const double mean_phi = state.guide->mean_phi(glm::dot(state.direction, state.normal));
  SteeredFlight& flight = state.flight;
  flight.steered = rng.uniform() < SteeredFlight::share;
  state.direction = flight.steered ? state.guide->scatter(state.direction, state.normal, rng)
                                   : alabaster::scatter(state.direction, medium_.g, rng);
  const double towards = glm::dot(state.direction, state.normal);
  flight.turn = state.guide->phi(towards) / mean_phi;
  flight.stretch = 1 - state.guide->kappa() * towards;
}

bool VolumeWalk::collide(State& state, Rng& rng) const {
  if (state.order >= options_.max_order) return ++state.lost, false;
  std::optional<Rgb> albedo;
  if (density_ != nullptr) {
    const auto closest = closest_point(state, state.reach, no_index);
    if (!closest) return ++state.lost, false;
    if (rng.uniform() >= density_->at(*closest).r) return true;  // a null collision: on as it was
    albedo = options_.albedo == WalkAlbedo::exit ? state.exit_albedo : albedo_.at(*closest);
  } else {
    albedo = this->albedo(state, rng);
  }
  ++state.order;
  if (!albedo) return ++state.lost, false;
  state.weight *= *albedo;
  double survival = magnitude(state.weight).max() / least_weight;
  if (state.guides != nullptr) {
    const DepthGuides::Choice& choice = state.guides->at(state.depth * sigma_t_.mean());
    state.guide = choice.guide;
    survival *= choice.importance * (least_weight / (least_share * state.guides->typical_weight()));
  }
  if (survival < 1) {
    if (rng.uniform() >= survival) return false;
    state.weight /= survival;
  }
  if (guide_ != nullptr) look_for_light(state, rng);
  scatter(state, rng);
  return true;
}

std::optional<Rgb> VolumeWalk::albedo(State& state, Rng& rng) const {
  if (!cells_)
    return options_.albedo == WalkAlbedo::exit ? state.exit_albedo
                                               : exact_albedo(state, state.reach, no_index);
  const AlbedoCells::View cell = cells_->at(state.position);
  state.normal = cell.normal;
  state.depth = cell.depth;
  if (options_.albedo == WalkAlbedo::exit) {
    state.clearance = std::max(state.clearance, cell.clearance - slack_);
    return state.exit_albedo;
  }
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
  const auto closest = closest_point(state, reach, guess);
  if (!closest) return std::nullopt;
  return albedo_.at(*closest);
}

std::optional<SurfacePoint> VolumeWalk::closest_point(State& state, double reach, uint32_t guess) const {
  const auto closest = rays_.closest_point(object_, state.position, reach + slack_, guess);
  ++state.queries;
  if (!closest) return std::nullopt;
  state.clearance = closest->distance - slack_;
  state.reach = closest->distance;
  if (!cells_) {
    state.normal = mesh_.geometric_normal(closest->triangle);
    state.depth = closest->distance;
  }
  SurfacePoint point;  // textures need no more of it
  point.triangle = closest->triangle;
  point.barycentric = closest->barycentric;
  point.uv = mesh_.uv(closest->triangle, closest->barycentric);
  return point;
}

bool VolumeWalk::meet_boundary(State& state, const Hit& hit, Rng& rng) const {
  if (hit.object != object_ || boundary_[mesh_.materials[hit.triangle]] == 0) return false;
  const SurfacePoint point = mesh_.surface_point(hit.triangle, hit.barycentric);
  const Vec3& normal = point.geometric_normal;
  const double cosine = glm::dot(state.direction, normal);
  if (cosine <= 0) return ++state.lost, false;  // met from outside: slipped through a crack
  state.end_inside = state.direction;
  state.end_distance = hit.t;
  state.end_reflected = state.triangle != no_index;
  state.position = point.position;
  state.triangle = hit.triangle;
  state.clearance = 0;
  state.reach = 0;
  if (reflected_inside(cosine, medium_.eta, rng)) {
    state.direction -= 2 * cosine * normal;
    begin_flight(state, normal, rng);
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
