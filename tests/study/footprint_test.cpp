#include "study/footprint.h"

#include <catch2/catch.hpp>

#include "core/rng.h"
#include "core/vec.h"

using namespace alabaster;

TEST_CASE("the fit finds the Gaussians that vertices were drawn from") {
  FootprintFit truth;
  truth.weight = {0.5, 0.3, 0.2};
  truth.position = {0.6, 0.2, 1.5};
  Rng rng(3);
  std::vector<FootprintVertex> vertices;
  for (int i = 0; i < 40000; ++i) {
    const double u = rng.uniform();
    const double t = truth.position[u < 0.5 ? 0 : u < 0.8 ? 1 : 2];
    const double r = t * std::sqrt(-2 * std::log(rng.uniform_positive())), angle = 2 * pi * rng.uniform();
    vertices.push_back(
        {static_cast<float>(t + r * std::cos(angle)), static_cast<float>(r * std::sin(angle)), 1});
  }
  const FootprintFit fit = fit_footprint(vertices);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(fit.weight[k] == Approx(truth.weight[k]).margin(0.04));
    CHECK(fit.position[k] == Approx(truth.position[k]).epsilon(0.08));
  }
}

TEST_CASE("eq. 1 is a density: it integrates to 1 over the pair's plane") {
  const FootprintFit paper;
  double sum = 0;
  const double step = 0.01;
  for (double u = -5; u < 6; u += step)
    for (double v = -5; v < 5; v += step) sum += paper.density(u, v) * step * step;
  CHECK(sum == Approx(1).epsilon(1e-3));
}

TEST_CASE(
    "path vertices lie midway between entry and exit, and spread with the order, not with the distance") {
  FootprintOptions options;
  options.paths = 60000;
  options.max_order = 100;
  options.distances = {1, 3};
  const std::vector<Footprint> footprints = measure_footprints(options);
  REQUIRE(footprints.size() == 2);
  for (const Footprint& f : footprints) {
    REQUIRE(f.paths > 200);
    // By exchange of entry and exit; vertices of one path are one observation.
    const double error = f.deviation_along / std::sqrt(static_cast<double>(f.paths));
    CHECK(std::abs(f.mean_along - 0.5) < 4 * error);
    double sum = 0;
    for (const double d : f.density) sum += d * 6.0 / (Footprint::columns * Footprint::rows);
    CHECK(sum == Approx(f.inside).epsilon(1e-9));
  }
  // In mean free paths: three times the distance, far less than three times the width.
  const double near = footprints[0].deviation_across * 1, far = footprints[1].deviation_across * 3;
  CHECK(far < 1.8 * near);
  CHECK(far > 0.5 * near);
}

TEST_CASE("a footprint does not depend on the number of threads") {
  FootprintOptions options;
  options.paths = 6400;
  options.max_order = 50;
  const auto a = measure_footprints(options), b = measure_footprints(options);
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i].density == b[i].density);
}
