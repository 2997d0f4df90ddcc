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

}  // namespace

ExpectedLight::ExpectedLight(std::span<const Distant> lights) {
  // The mean over all normals of a cosine cut at 0 is a quarter.
  double mean = 0;
  for (const Distant& light : lights) mean += 0.25 * light.irradiance;
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

double ExpectedLight::relative(const Vec3& normal) const {
  return double{relative_[cell(normal)]};
}

Vec3 ExpectedLight::direction(const Vec3& normal) const {
  return Vec3(direction_[cell(normal)]);
}

}  // namespace alabaster
