#include "bssrdf/expected_light.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/rng.h"

using namespace alabaster;

namespace {

Vec3 uniform_direction(Rng& rng) {
  const double z = 2 * rng.uniform() - 1, phi = 2 * pi * rng.uniform(), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace

TEST_CASE("expected light follows the cosine and never vanishes", "[bssrdf]") {
  const Vec3 sun = glm::normalize(Vec3(-0.6, 0.62, -0.5));
  const ExpectedLight light(std::array{ExpectedLight::Distant{sun, 3}});
  Rng rng(3);
  double mean = 0;
  constexpr int count = 20000;
  for (int i = 0; i < count; ++i) {
    const Vec3 normal = uniform_direction(rng);
    const double expected = 4 * std::max(0.0, glm::dot(normal, sun));
    mean += light.relative(normal) / count;
    // A cell of the map is at most 0.12 wide on the sphere, the slope of the cosine at most 4.
    REQUIRE(std::abs(light.relative(normal) - std::max(0.05, expected)) < 4 * 0.12);
    REQUIRE(light.relative(normal) >= 0.0499);
  }
  CHECK(mean == Approx(1 + 0.5 * 0.05).margin(0.03));
}

TEST_CASE("without light, or with the same from all sides, all entries may expect the same", "[bssrdf]") {
  CHECK(ExpectedLight({}).relative(Vec3(0, 0, 1)) == 1);
  std::array<ExpectedLight::Distant, 4096> lights;
  Rng rng(5);
  for (auto& light : lights) light = {uniform_direction(rng), 1.0 / 4096};
  const ExpectedLight uniform(lights);
  for (int i = 0; i < 100; ++i) CHECK(uniform.relative(uniform_direction(rng)) == Approx(1).margin(0.06));
}

TEST_CASE("light's expected direction is the mean by irradiance of what shines on the surface", "[bssrdf]") {
  const Vec3 left(-0.8, 0, 0.6), right(0.8, 0, 0.6), below(0, 0, -1);
  using Distant = ExpectedLight::Distant;
  const ExpectedLight light(std::array{Distant{left, 3}, Distant{right, 1}, Distant{below, 5}});
  // Facing up: 3/4 of the light comes from the left, nothing from below. A cell of the map is 0.12 wide.
  const Vec3 up = light.direction(Vec3(0, 0, 1));
  CHECK(glm::distance(up, 0.75 * left + 0.25 * right) < 0.12);
  CHECK(glm::distance(light.direction(glm::normalize(Vec3(-1, 0, 0.2))), left) < 1e-6);
  CHECK(glm::length(ExpectedLight({}).direction(Vec3(0, 0, 1))) == 0);
}
