#include "integrators/volume_walk_state.h"
#include "optics/fresnel.h"
#include "optics/phase_function.h"

namespace alabaster {

namespace {

// Facets tried before a search is given up.
constexpr int most_facets = 4;
// Deeper collisions look for light less often, by this power of e per mean free path; but all of them may,
// since a light met by chance from where nothing looks for it would count in full, and be a firefly. What the
// number is changes the noise alone.
constexpr double look_decay = 0.7;

// Snell's law backwards: the direction inside that leaves through a facet towards `outside`.
Vec3 refracted_inside(const Vec3& outside, const Vec3& normal, double eta) {
  const Vec3 along = (outside - glm::dot(outside, normal) * normal) / eta;
  return along + std::sqrt(std::max(0.0, 1 - glm::dot(along, along))) * normal;
}

}  // namespace

// What a path weighs that goes straight from the vertex to the crossing. It can come about in two ways: by
// scattering there, flying as far and being refracted; or by drawing the outside direction from the guide.
// The balance heuristic gives both the same weight, the path's value over the sum of both densities.
Rgb VolumeWalk::weight_of(const Vertex& vertex, const Crossing& crossing, double light_pdf) const {
  const Vec3& normal = crossing.point.geometric_normal;
  const double cos_inside = std::min(1.0, glm::dot(crossing.inside, normal));
  const double cos_outside = glm::dot(crossing.outside, normal);
  const Rgb passed = attenuation(sigma_t_, crossing.distance);
  const double value = henyey_greenstein(glm::dot(vertex.direction, crossing.inside), medium_.g) *
                       (1 - fresnel_dielectric(cos_inside, 1 / medium_.eta));
  // d(outside) / d(inside) of a refraction through a plane.
  const double spread = cos_outside > 0 ? medium_.eta * medium_.eta * cos_inside / cos_outside : 0;
  Rgb drawn = passed;
  if (vertex.guide != nullptr) {
    const double before = glm::dot(vertex.direction, vertex.normal);
    const double towards = glm::dot(crossing.inside, vertex.normal);
    const SteeredFlight flight{false, vertex.guide->phi(towards) / vertex.guide->mean_phi(before),
                               1 - vertex.guide->kappa() * towards};
    drawn = passed * steered_density(flight, crossing.distance, false);
  }
  const double density = value * mixture(vertex.weight, drawn) + vertex.probability * light_pdf * spread;
  return density > 0 ? vertex.weight * passed * (value / density) : Rgb();
}

void VolumeWalk::look_for_light(State& state, Rng& rng) const {
  Vertex& vertex = state.vertex;
  vertex.position = state.position;
  vertex.direction = state.direction;
  vertex.normal = state.normal;
  vertex.depth = state.depth;
  vertex.weight = state.weight;
  vertex.guide = state.guide;
  const double depth = state.depth * sigma_t_.mean();
  vertex.probability = std::exp(-look_decay * depth);
  if (rng.uniform() >= vertex.probability) return;
  const auto light = guide_->sample(vertex.position, vertex.normal, rng);
  if (!light) return;
  // What it promises, the surface taken for a plane.
  Crossing guess;
  guess.outside = light->direction;
  guess.inside = refracted_inside(light->direction, vertex.normal, medium_.eta);
  guess.point.geometric_normal = vertex.normal;
  guess.distance = vertex.depth / glm::dot(guess.inside, vertex.normal);
  const double promise = magnitude(weight_of(vertex, guess, light->pdf)).mean() * light->brightness;
  state.promised += promise;
  if (promise > 0 && rng.uniform() * state.promised < promise)
    state.candidate = {vertex, light->direction, light->pdf, promise, state.order};
}

// The facet through which the straight way from the vertex refracts into `outside`: the facet that is met
// sets the direction of the next try, until one is met twice. Deterministic, so that whether it finds a given
// way can be told for ways that came about otherwise.
std::optional<VolumeWalk::Crossing> VolumeWalk::search(const Vertex& vertex, const Vec3& outside,
                                                       int64_t& rays) const {
  Vec3 normal = vertex.normal;
  uint32_t last = no_index;
  for (int i = 0; i < most_facets; ++i) {
    if (glm::dot(outside, normal) <= 0) return std::nullopt;
    const Vec3 inside = refracted_inside(outside, normal, medium_.eta);
    const auto hit = rays_.nearest(Ray{vertex.position, inside});
    ++rays;
    if (!hit || hit->object != object_ || boundary_[mesh_.materials[hit->triangle]] == 0) return std::nullopt;
    const bool found = hit->triangle == last || medium_.eta == 1;
    last = hit->triangle;
    normal = mesh_.geometric_normal(last);
    if (!found) continue;
    if (glm::dot(inside, normal) <= 0) return std::nullopt;
    Crossing crossing{inside, outside, mesh_.surface_point(last, hit->barycentric), hit->t};
    crossing.point.object = object_;
    return crossing;
  }
  return std::nullopt;
}

// The walk's own exit, seen as one of both ways to come about.
Rgb VolumeWalk::weight_of_exit(State& state) const {
  if (state.end_reflected || state.vertex.probability == 0) return state.weight;
  const Vertex& vertex = state.vertex;
  double pdf = guide_->pdf(vertex.position, vertex.normal, state.direction);
  if (pdf > 0) {
    const auto crossing = search(vertex, state.direction, state.rays);
    if (!crossing || crossing->point.triangle != state.end.triangle) pdf = 0;
  }
  return weight_of(vertex, {state.end_inside, state.direction, state.end, state.end_distance}, pdf);
}

std::optional<VolumeWalkExit> VolumeWalk::choose_exit(State& state, Rng& rng) const {
  VolumeWalkExit exit{state.end, state.direction, state.weight, state.order};
  double promise = 0;
  if (state.left) {
    if (state.order == 0) return exit;
    exit.weight = weight_of_exit(state);
    promise = magnitude(exit.weight).mean() * guide_->brightness(state.end.position, state.direction);
  }
  const double total = promise + state.promised;
  if (!(total > 0)) return std::nullopt;
  if (rng.uniform() * total < promise) {
    exit.weight *= total / promise;
    return exit;
  }
  const Candidate& candidate = state.candidate;
  const auto crossing = search(candidate.vertex, candidate.outside, state.rays);
  if (!crossing || !(candidate.promise > 0)) return std::nullopt;
  const Rgb weight = weight_of(candidate.vertex, *crossing, candidate.pdf);
  return VolumeWalkExit{crossing->point, crossing->outside, weight * (total / candidate.promise),
                        candidate.order};
}

}  // namespace alabaster
