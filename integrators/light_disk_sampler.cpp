#include "integrators/light_disk_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace alabaster {
namespace {

// Exits inside the disk: the square root of their depth below its edge is evenly spaced, for what lies
// outwards of an exit changes fastest at the edge. Outside: the inverse of the distance is, up to the last
// node, which serves all farther ones.
constexpr std::size_t inside_nodes = 24, outside_nodes = 24, node_count = inside_nodes + outside_nodes;
constexpr double farthest_node = 6;  // radii
constexpr std::size_t angle_bins = 32;
/// Of the mean share, given to every direction.
constexpr double least_share = 0.01;
/// Below this share of all distances the table's differences are mostly rounding.
constexpr double smallest_share = 1e-6, smallest_chord_share = 1e-9;
/// Outside, by how much the density by area may vary over the disk: measured.
constexpr double even_contrast = 2;

}  // namespace

LightDiskSampler::LightDiskSampler(const DistanceTable& distances, double sigma_t, double radius)
    : distances_(distances),
      sigma_t_(sigma_t),
      radius_(radius),
      cumulative_(node_count * DistanceTable::level_count * (angle_bins + 1)),
      even_(node_count * DistanceTable::level_count) {
  for (std::size_t node = 0; node < node_count; ++node)
    for (int level = 0; level < DistanceTable::level_count; ++level) tabulate(node, level);
}

double LightDiskSampler::offset_of_node(std::size_t node) const {
  if (node < inside_nodes) {
    const double root = (static_cast<double>(node) + 0.5) / inside_nodes;
    return 1 - root * root;
  }
  const double t = (static_cast<double>(node - inside_nodes) + 0.5) / outside_nodes;
  return 1 / (1 - t * (1 - 1 / farthest_node));
}

LightDiskSampler::View LightDiskSampler::view(Vec2 exit_to_centre) const {
  View view;
  view.offset = glm::length(exit_to_centre);
  if (view.offset > 0) view.towards = exit_to_centre / view.offset;
  const double radii = view.offset / radius_;
  if (radii <= 1) {
    const auto node = static_cast<std::size_t>(std::sqrt(1 - radii) * inside_nodes);
    view.node = std::min(node, inside_nodes - 1);
  } else {
    view.widest = std::asin(1 / radii);
    const double t = (1 - 1 / radii) / (1 - 1 / farthest_node);
    view.node = inside_nodes + std::min(static_cast<std::size_t>(t * outside_nodes), outside_nodes - 1);
  }
  return view;
}

LightDiskSampler::Place LightDiskSampler::chord(const View& view, double angle, Vec2 direction) const {
  const double middle = view.offset * direction.x, beside = view.offset * direction.y;
  const double half = std::sqrt(std::max(0.0, radius_ * radius_ - beside * beside));
  Place place;
  place.angle = angle;
  place.direction = direction;
  if (view.offset > radius_) {
    place.nearest = std::max(0.0, middle - half);
    place.farthest = middle + half;
  } else {  // the form that does not cancel
    const double power = (radius_ - view.offset) * (radius_ + view.offset);
    place.farthest = middle >= 0 ? middle + half : power / (half - middle);
  }
  return place;
}

void LightDiskSampler::tabulate(std::size_t node, int level) {
  const View at_node = view(Vec2(radius_ * offset_of_node(node), 0));
  std::array<double, angle_bins> share{};
  double total = 0;
  for (std::size_t k = 0; k < angle_bins; ++k) {
    const double angle = (static_cast<double>(k) + 0.5) / angle_bins * at_node.widest;
    const Place place = chord(at_node, angle, Vec2(std::cos(angle), std::sin(angle)));
    total += share[k] =
        distances_.cdf(level, sigma_t_ * place.farthest) - distances_.cdf(level, sigma_t_ * place.nearest);
  }
  float* row = &cumulative_[index(node, level) * (angle_bins + 1)];
  const double least = std::max(least_share * total / angle_bins, 1e-30);
  double sum = 0;
  for (double& s : share) sum += s = std::max(s, least);
  double below = 0;
  for (std::size_t k = 0; k < angle_bins; ++k) {
    row[k] = static_cast<float>(below / sum);
    below += share[k];
  }
  row[angle_bins] = 1;

  if (node < inside_nodes) return;
  const double nearest = at_node.offset - radius_, farthest = at_node.offset + radius_;
  const double contrast = distances_.pdf(level, sigma_t_ * nearest) * farthest /
                          (distances_.pdf(level, sigma_t_ * farthest) * nearest);
  even_[index(node, level)] = total / angle_bins < smallest_share || contrast < even_contrast;
}

std::optional<LightDiskSampler::Place> LightDiskSampler::place(const View& view, Vec2 displacement) const {
  const Vec2 side(-view.towards.y, view.towards.x);
  const Vec2 local(glm::dot(displacement, view.towards), glm::dot(displacement, side));
  const double angle = std::atan2(local.y, local.x), distance = glm::length(local);
  if (!(distance > 0 && std::abs(angle) <= view.widest)) return std::nullopt;
  Place place = chord(view, angle, local / distance);
  if (!(place.farthest > place.nearest)) return std::nullopt;
  place.distance = distance;
  return place;
}

Vec2 LightDiskSampler::displacement(const View& view, const Place& place) const {
  const Vec2 side(-view.towards.y, view.towards.x);
  return place.distance * (place.direction.x * view.towards + place.direction.y * side);
}

std::optional<LightDiskSampler::Place> LightDiskSampler::sample(const View& view, int level, Vec2 u) const {
  const float* row = &cumulative_[index(view.node, level) * (angle_bins + 1)];
  // One number for the side and the place on it.
  const bool left = u.y < 0.5;
  const auto wanted = static_cast<float>(left ? 1 - 2 * u.y : 2 * u.y - 1);
  const auto bin =
      std::min<std::ptrdiff_t>(std::upper_bound(row + 1, row + angle_bins, wanted) - row - 1, angle_bins - 1);
  const double within = std::min(1.0, static_cast<double>((wanted - row[bin]) / (row[bin + 1] - row[bin])));
  const double angle = (left ? -1 : 1) * (static_cast<double>(bin) + within) / angle_bins * view.widest;
  Place place = chord(view, angle, Vec2(std::cos(angle), std::sin(angle)));
  if (!(place.farthest > place.nearest)) return std::nullopt;
  const double below = distances_.cdf(level, sigma_t_ * place.nearest);
  const double share = distances_.cdf(level, sigma_t_ * place.farthest) - below;
  const double drawn = share > smallest_chord_share ? distances_.sample(level, below + u.x * share) / sigma_t_
                                                    : place.nearest + u.x * (place.farthest - place.nearest);
  place.distance = std::clamp(drawn, place.nearest, place.farthest);
  if (!(place.distance > 0)) return std::nullopt;
  return place;
}

double LightDiskSampler::pdf(const View& view, int level, const Place& place) const {
  const float* row = &cumulative_[index(view.node, level) * (angle_bins + 1)];
  const double along = std::abs(place.angle) / view.widest * angle_bins;
  const std::size_t bin = std::min(static_cast<std::size_t>(along), angle_bins - 1);
  const double by_angle = static_cast<double>(row[bin + 1] - row[bin]) * angle_bins / (2 * view.widest);
  const double share =
      distances_.cdf(level, sigma_t_ * place.farthest) - distances_.cdf(level, sigma_t_ * place.nearest);
  const double by_distance = share > smallest_chord_share
                                 ? sigma_t_ * distances_.pdf(level, sigma_t_ * place.distance) / share
                                 : 1 / (place.farthest - place.nearest);
  return by_angle * by_distance / place.distance;
}

}  // namespace alabaster
