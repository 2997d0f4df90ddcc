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
    mean += light.relative(Vec3(0), normal, 1) / count;
    // A cell of the map is at most 0.12 wide on the sphere, the slope of the cosine at most 4.
    REQUIRE(std::abs(light.relative(Vec3(0), normal, 1) - std::max(0.05, expected)) < 4 * 0.12);
    REQUIRE(light.relative(Vec3(0), normal, 1) >= 0.0499);
  }
  CHECK(mean == Approx(1 + 0.5 * 0.05).margin(0.03));
}

TEST_CASE("without light, or with the same from all sides, all entries may expect the same", "[bssrdf]") {
  CHECK(ExpectedLight({}).relative(Vec3(0), Vec3(0, 0, 1), 0) == 1);
  std::array<ExpectedLight::Distant, 4096> lights;
  Rng rng(5);
  for (auto& light : lights) light = {uniform_direction(rng), 1.0 / 4096};
  const ExpectedLight uniform(lights);
  for (int i = 0; i < 100; ++i)
    CHECK(uniform.relative(Vec3(0), uniform_direction(rng), 1) == Approx(1).margin(0.06));
}

TEST_CASE("light's expected direction is the mean by irradiance of what shines on the surface", "[bssrdf]") {
  const Vec3 left(-0.8, 0, 0.6), right(0.8, 0, 0.6), below(0, 0, -1);
  using Distant = ExpectedLight::Distant;
  const ExpectedLight light(std::array{Distant{left, 3}, Distant{right, 1}, Distant{below, 5}});
  // Facing up: 3/4 of the light comes from the left, nothing from below. A cell of the map is 0.12 wide.
  const Vec3 up = light.direction(Vec3(0), Vec3(0, 0, 1));
  CHECK(glm::distance(up, 0.75 * left + 0.25 * right) < 0.12);
  CHECK(glm::distance(light.direction(Vec3(0), glm::normalize(Vec3(-1, 0, 0.2))), left) < 1e-6);
  CHECK(glm::length(ExpectedLight({}).direction(Vec3(0), Vec3(0, 0, 1))) == 0);
}

TEST_CASE("lamps shine on what faces them by the square of the distance, within their cone", "[bssrdf]") {
  using Lamp = ExpectedLight::Lamp;
  const Vec3 up(0, 0, 1), aside(1, 0, 0);
  // Straight above by 2 m, and aside by 4 m: 8 / 4 and 16 / 16 W/m^2.
  const ExpectedLight two({}, std::array{Lamp{2.0 * up, 8}, Lamp{4.0 * aside, 16}});
  CHECK(two.mean(Vec3(0)) == Approx(0.25 * (2 + 1)));
  CHECK(two.relative(Vec3(0), up, 1) == Approx(2));
  CHECK(two.relative(Vec3(0), aside, 1) == Approx(1));
  CHECK(two.relative(Vec3(0), aside, 0.5) == Approx(2));
  CHECK(two.relative(Vec3(0), -up, 1) == 0.05);
  const Vec3 between = glm::normalize(up + aside);
  CHECK(glm::distance(two.direction(Vec3(0), between), (2.0 * up + aside) / 3.0) < 1e-12);
  // Beside the sky, which alone gives the mean of all normals to this one.
  const ExpectedLight both(std::array{ExpectedLight::Distant{aside, 4}}, std::array{Lamp{2.0 * up, 8}});
  CHECK(both.mean(Vec3(0)) == Approx(1 + 0.5));
  CHECK(both.relative(Vec3(0), up, 1.5) == Approx((2 + 0.05) / 1.5).margin(0.4 / 1.5));

  // A cone straight down, half as bright where the cosine is 0.75.
  const ExpectedLight spot({}, std::array{Lamp{up, 1, -up, 0.5, 1}});
  const auto below = [](double cosine) { return Vec3(std::sqrt(1 / (cosine * cosine) - 1), 0, 0); };
  CHECK(spot.mean(Vec3(0)) == Approx(0.25));
  CHECK(spot.mean(below(0.75)) == Approx(0.25 * 0.5 * 0.75 * 0.75));
  CHECK(spot.mean(below(0.4)) == 0);
  CHECK(spot.relative(below(0.4), up, 0) == 1);
  // No brighter from within its size.
  const ExpectedLight wide({}, std::array{Lamp{up, 1, Vec3(0), -1, 0, 2}});
  CHECK(wide.mean(Vec3(0)) == Approx(0.25 / 4));
}
