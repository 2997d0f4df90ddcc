#include "bssrdf/area_sampler.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "core/statistics.h"
#include "geometry/shapes.h"

using namespace alabaster;

TEST_CASE(
    "points by area: triangles by their area, uniform inside, none that does not count (chi-square, 1e-3)",
    "[bssrdf]") {
  // An ellipsoid's triangles differ in area several times over; every third is left out.
  const TriangleMesh mesh = make_ellipsoid(Vec3(0.2, 1, 4), 10);
  const auto counts = [](uint32_t triangle) { return triangle % 3 != 0; };
  const AreaSampler sampler(mesh, counts);
  double area = 0, least = 1e9, most = 0;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
    if (counts(t)) {
      area += mesh.area(t);
      least = std::min(least, mesh.area(t));
      most = std::max(most, mesh.area(t));
    }
  CHECK(sampler.area() == Approx(area));
  REQUIRE(most > 3 * least);

  // Each triangle in four: its three corners' quarters and the middle, of equal area.
  const std::size_t cells = 4 * mesh.triangle_count();
  std::vector<double> observed(cells);
  Rng rng(19);
  const double draws = 40 * static_cast<double>(cells);
  for (double i = 0; i < draws; i += 1) {
    const auto [triangle, b] = sampler.sample({rng.uniform(), rng.uniform()});
    REQUIRE(counts(triangle));
    REQUIRE((b.x >= 0 && b.y >= 0 && b.x + b.y <= 1));
    const std::size_t part = b.x > 0.5 ? 0 : b.y > 0.5 ? 1 : b.x + b.y < 0.5 ? 2 : 3;
    observed[4 * triangle + part] += 1;
  }
  double statistic = 0, tested = 0;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!counts(t)) continue;
    const double expected = draws * mesh.area(t) / (4 * area);
    if (expected < 5) continue;
    for (std::size_t part = 0; part < 4; ++part, ++tested)
      statistic += std::pow(observed[4 * t + part] - expected, 2) / expected;
  }
  REQUIRE(tested > 200);
  CHECK(chi_square_p_value(statistic, tested - 1) > 1e-3);
}
