#include "core/frame.h"

#include <catch2/catch.hpp>

#include "core/rng.h"

using namespace alabaster;

TEST_CASE("a frame is right-handed and orthonormal for every normal") {
  Rng rng(3);
  const auto check = [](const Vec3& n) {
    const Frame f(n);
    CHECK(glm::length(glm::cross(f.tangent, f.bitangent) - f.normal) < 1e-12);
    CHECK(glm::dot(f.tangent, f.bitangent) == Approx(0).margin(1e-12));
    CHECK(glm::length(f.tangent) == Approx(1).epsilon(1e-12));
    const Vec3 v{0.3, -0.7, 0.2};
    CHECK(glm::length(f.to_local(f.to_world(v)) - v) < 1e-12);
  };
  check({0, 0, 1});
  check({0, 0, -1});
  check({0, 0, -0.0 - 1});
  for (int i = 0; i < 100; ++i) {
    const double z = 2 * rng.uniform() - 1, phi = 2 * pi * rng.uniform(), r = std::sqrt(1 - z * z);
    check({r * std::cos(phi), r * std::sin(phi), z});
  }
}

TEST_CASE("streams of the generator are uniform in mean and uncorrelated with each other") {
  // z-tests at 1e-5 two-sided (|z| < 4.42), fixed seed.
  const int n = 100000;
  double sum = 0, product = 0;
  Rng a(1, 0), b(1, 1);
  for (int i = 0; i < n; ++i) {
    const double x = a.uniform() - 0.5, y = b.uniform() - 0.5;
    sum += x, product += x * y;
  }
  CHECK(std::abs(sum) / std::sqrt(n / 12.0) < 4.42);
  CHECK(std::abs(product) / std::sqrt(n / 144.0) < 4.42);
}
