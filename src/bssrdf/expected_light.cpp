#include "bssrdf/expected_light.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

namespace {

constexpr double least = 0.05;

// The sphere on a square by way of the octahedron (Meyer et al. 2010, "On floating-point normal vectors").
Vec2 to_square(const Vec3& n) {
  const double scale = 1 / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  const Vec2 p(n.x * scale, n.y * scale);
  if (n.z >= 0) return p;
  return {std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y)};
}

Vec3 from_square(Vec2 p) {
  Vec3 n(p, 1 - std::abs(p.x) - std::abs(p.y));
  if (n.z < 0) n = Vec3(std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y), n.z);
  return glm::normalize(n);
}

struct Arriving {
  Vec3 direction;     // unit, towards the lamp
  double irradiance;  // on a surface that faces it
};

Arriving arriving(const ExpectedLight::Lamp& lamp, const Vec3& position) {
  const Vec3 towards = lamp.position - position;
  const double distance = std::max(glm::length(towards), 1e-100);
  const Vec3 direction = towards / distance;
  const double share = (-glm::dot(direction, lamp.axis) - lamp.none) / (lamp.full - lamp.none);
  const double from = std::max(distance, lamp.size);
  return {direction, lamp.intensity * std::clamp(share, 0.0, 1.0) / (from * from)};
}

}  // namespace

ExpectedLight::ExpectedLight(std::span<const Distant> lights, std::span<const Lamp> lamps)
    : lamps_(lamps.begin(), lamps.end()) {
  // The mean over all normals of a cosine cut at 0 is a quarter.
  double mean = 0;
  for (const Distant& light : lights) mean += 0.25 * light.irradiance;
  distant_mean_ = mean;
  std::size_t place = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Vec3 normal = from_square(Vec2(x + 0.5, y + 0.5) * (2.0 / side) - 1.0);
      double sum = 0;
      Vec3 towards(0);
      for (const Distant& light : lights) {
        const double irradiance = std::max(0.0, glm::dot(normal, light.direction)) * light.irradiance;
        sum += irradiance;
        towards += irradiance * light.direction;
      }
      if (sum > 0) direction_[place] = Vec3f(towards / sum);
      relative_[place++] = static_cast<float>(mean > 0 ? std::max(least, sum / mean) : 1);
    }
}

std::size_t ExpectedLight::cell(const Vec3& normal) {
  const Vec2 p = (to_square(normal) + 1.0) * (0.5 * side);
  const auto step = [](double q) { return static_cast<std::size_t>(std::clamp(q, 0.0, side - 0.5)); };
  return step(p.y) * side + step(p.x);
}

double ExpectedLight::mean(const Vec3& position) const {
  double sum = distant_mean_;
  for (const Lamp& lamp : lamps_) sum += 0.25 * arriving(lamp, position).irradiance;
  return sum;
}

double ExpectedLight::relative(const Vec3& position, const Vec3& normal, double mean) const {
  const double distant = double{relative_[cell(normal)]};
  if (lamps_.empty()) return distant;
  if (!(mean > 0)) return 1;
  double sum = distant_mean_ * distant;
  for (const Lamp& lamp : lamps_) {
    const auto [direction, irradiance] = arriving(lamp, position);
    sum += std::max(0.0, glm::dot(normal, direction)) * irradiance;
  }
  return std::max(least, sum / mean);
}

Vec3 ExpectedLight::direction(const Vec3& position, const Vec3& normal) const {
  const std::size_t at = cell(normal);
  if (lamps_.empty()) return Vec3(direction_[at]);
  double sum = distant_mean_ * double{relative_[at]};
  Vec3 towards = sum * Vec3(direction_[at]);
  for (const Lamp& lamp : lamps_) {
    const auto [direction, facing] = arriving(lamp, position);
    const double irradiance = std::max(0.0, glm::dot(normal, direction)) * facing;
    sum += irradiance;
    towards += irradiance * direction;
  }
  return sum > 0 ? towards / sum : Vec3(0);
}

}  // namespace alabaster
