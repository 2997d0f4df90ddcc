#include "bssrdf/probe_sampler.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "bssrdf/area_sampler.h"
#include "bssrdf/placements.h"
#include "core/rng.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "support/analytic_albedo.h"
#include "support/analytic_profile.h"
#include "support/mesh_integral.h"

using namespace alabaster;

namespace {

/// A mesh with everything that entry sampling needs. Lengths in metres.
struct Body {
  explicit Body(TriangleMesh given) : mesh(std::move(given)) {
    rays.add(mesh);
    rays.commit();
  }
  ProbeTarget target() const { return {&rays, &mesh, 0, {}}; }
  TriangleMesh mesh;
  RayScene rays;
};

EntryRandom draw_random(Rng& rng) {
  return {{rng.uniform(), rng.uniform()}, {rng.uniform(), rng.uniform()}};
}

/// Points spread over the mesh, away from the border of open ones.
std::vector<SurfacePoint> some_exits(const TriangleMesh& mesh, int count, uint64_t seed) {
  const AreaSampler area(mesh, [](uint32_t) { return true; });
  Rng rng(seed);
  std::vector<SurfacePoint> exits;
  for (int k = 0; k < count; ++k) {
    const auto [triangle, barycentric] = area.sample({rng.uniform(), rng.uniform()});
    exits.push_back(mesh.surface_point(triangle, barycentric));
  }
  return exits;
}

struct Shape {
  const char* name;
  TriangleMesh mesh;
};

std::vector<Shape> shapes() {
  std::vector<Shape> list;
  list.push_back({"plane", make_plane(30, 12)});
  list.push_back({"sphere of radius 3", make_sphere(3, 24)});
  list.push_back({"folded sheet", make_folded_sheet(8, 1.5, 0.2, 16)});
  return list;
}

}  // namespace

TEST_CASE("entries are as dense as density() states, triangle by triangle", "[bssrdf]") {
  const AnalyticProfile profile;
  // Colours and mean free paths differ, so every component of the radius is in play.
  const CosineAlbedo albedo(Rgb(0.95, 0.7, 0.3));
  const BssrdfMedium medium{&profile, Rgb(0.7, 1, 2), &albedo};
  const auto model = make_bssrdf("homogeneous", medium, {});
  constexpr int count = 30000;
  for (const Shape& shape : shapes()) {
    const Body body(shape.mesh);
    const ProbeSampler sampler(*model, body.target());
    for (const SurfacePoint& point : some_exits(body.mesh, 2, 5)) {
      const auto exit = sampler.prepare(medium.point(point));
      REQUIRE(exit);
      std::vector<double> sum(body.mesh.triangle_count()), squares(sum.size());
      std::array<EntrySample, 32> entries;
      Rng rng(11);
      for (int i = 0; i < count; ++i) {
        const std::size_t found = sampler.sample_entries(exit->point, draw_random(rng), entries);
        REQUIRE(found < entries.size());
        for (std::size_t k = 0; k < found; ++k) sum[entries[k].point.surface.triangle] += 1;
      }
      const auto density = [&](uint32_t triangle, Vec2 barycentric) {
        return sampler.density(*exit, body.mesh.surface_point(triangle, barycentric));
      };
      const TriangleIntegral integral(body.mesh, density, 1e-6);
      // Counts of one triangle are binomial (a line meets a triangle once); those of two may be correlated,
      // so every triangle gets a z-test of its own.
      double worst = 0, total = 0, statistic = 0;
      int tested = 0;
      for (uint32_t t = 0; t < sum.size(); ++t) {
        const double p = integral.over(t);
        total += p;
        if (p * count < 10) continue;
        const double z = (sum[t] - p * count) / std::sqrt(count * p * (1 - p));
        worst = std::max(worst, std::abs(z));
        statistic += z * z;
        ++tested;
      }
      CAPTURE(shape.name, worst, tested, total, statistic);
      CHECK(tested > 50);
      CHECK(two_sided_normal_p_value(worst) > sidak(0.01, 6.0 * tested));
      // On the plane a draw has at most one entry, so the counts are multinomial.
      if (std::string_view(shape.name) == "plane")
        CHECK(chi_square_p_value(statistic, tested) > sidak(0.01, 6));
    }
  }
}
