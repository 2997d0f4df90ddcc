#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <vector>

#include "bssrdf/basis.h"
#include "bssrdf/body.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "support/analytic_albedo.h"

using namespace alabaster;

// What one draw of an entry is worth: its relative standard deviation for uniform irradiance, and how often
// it finds nothing. The table of docs/probe_sampling.md.

namespace {

struct Worth {
  double deviation = 0;  // relative, of one draw, over exits all over the shape
  double empty = 0;      // fraction of draws without an entry
};

Worth worth_of_a_draw(const Body& body, const Bssrdf& model, double exits_within) {
  const ProbeSampler sampler(model, body.target());
  constexpr int exits = 40, draws = 300;
  Rng rng(1);
  double variance = 0, mean = 0, empty = 0;
  int used = 0;
  for (const SurfacePoint& point : points_on(body.mesh, 40 * exits, 2)) {
    if (glm::length(point.position) > exits_within) continue;
    const BssrdfPoint exit = model.medium().point(point);
    RunningMoments moments;
    for (int i = 0; i < draws; ++i) {
      const auto entry = sampler.sample_entry(exit, entry_random(rng));
      moments.add(entry ? entry->weight.mean() : 0);
      empty += !entry;
    }
    variance += moments.variance();
    mean += moments.mean();
    if (++used == exits) break;
  }
  return {std::sqrt(variance / used) / (mean / used), empty / used / draws};
}

}  // namespace

TEST_CASE("worth of one draw", "[.][bench]") {
  struct Case {
    const char* name;
    TriangleMesh mesh;
    double exits_within = 1e30;  // of the origin, where the mesh stands for an unbounded one
  };
  std::vector<Case> cases;
  cases.push_back({"plane", make_plane(1000, 64), 100});
  cases.push_back({"sphere 20", make_sphere(20)});
  cases.push_back({"sphere 3", make_sphere(3, 96)});
  cases.push_back({"sphere 1", make_sphere(1, 64)});
  cases.push_back({"blob 20", make_blob(20, 0.25)});
  cases.push_back({"torus 9/3", make_torus(9, 3)});
  cases.push_back({"slab 1", make_slab(60, 1, 32)});
  cases.push_back({"fold 20/2", make_folded_sheet(20, 2, 0.2, 64)});
  std::printf("%-24s", "");
  for (const Case& c : cases) std::printf("%16s", c.name);
  std::printf("\n");
  struct Row {
    const char* name;
    Rgb mean, amplitude;
  };
  const Row rows[] = {{"albedo 0.5", Rgb(0.5), Rgb(0)},
                      {"albedo 0.9", Rgb(0.9), Rgb(0)},
                      {"albedo 0.99", Rgb(0.99), Rgb(0)},
                      {"stripes 0.5 to 0.95", Rgb(0.725), Rgb(0.225)},
                      {"stripes 0.2 to 0.99", Rgb(0.595), Rgb(0.395)}};
  for (const Row& row : rows) {
    for (const Basis basis : {Basis::half_space, Basis::shape}) {
      std::printf("%-24s", basis == Basis::shape ? "  with the shape basis" : row.name);
      for (const Case& c : cases) {
        Body body(c.mesh);
        const double stripes = 0.2 * bounding_box(c.mesh).diagonal();
        const CosineAlbedo albedo(row.mean, row.amplitude, {row.amplitude.r > 0 ? stripes : 0, 0});
        const BssrdfMedium medium{&baseline_profile(), Rgb(1), &albedo,
                                  basis == Basis::shape ? body.shape() : nullptr};
        BssrdfOptions options;
        options.placement = &body.placement;
        const auto model = make_bssrdf("composite", medium, options);
        const Worth worth = worth_of_a_draw(body, *model, c.exits_within);
        std::printf("%8.2f (%3.0f %%)", worth.deviation, 100 * worth.empty);
      }
      std::printf("\n");
    }
  }
}
