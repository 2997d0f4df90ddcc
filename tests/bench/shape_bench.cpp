// Figures of docs/shape_basis.md: build/release/tests/test_bench "[shape]".

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <vector>

#include "bssrdf/probe_sampler.h"
#include "core/parallel.h"
#include "geometry/curvature.h"
#include "integrators/bssrdf_transport.h"
#include "study/mesh_scene.h"

using namespace alabaster;

namespace {

struct Pairs {
  std::vector<BssrdfPoint> entries, exits;
};

// As rendering asks for them: exits by area, entries by probes.
Pairs draw_pairs(const ProbeSampler& probe, const TriangleMesh& mesh, int exits, int entries) {
  const AreaSampler area(mesh, [](uint32_t) { return true; });
  Rng rng(3);
  Pairs pairs;
  for (int k = 0; k < exits; ++k) {
    const auto [triangle, barycentric] = area.sample({rng.uniform(), rng.uniform()});
    const BssrdfPoint exit = probe.model().medium().point(mesh.surface_point(triangle, barycentric));
    for (int i = 0; i < entries; ++i) {
      const EntryRandom u{{rng.uniform(), rng.uniform()}, {rng.uniform(), rng.uniform()}};
      const auto entry = probe.sample_entry(exit, u);
      if (!entry) continue;
      pairs.exits.push_back(exit);
      pairs.entries.push_back(entry->point);
    }
  }
  return pairs;
}

// Nanoseconds of CPU time per evaluation.
double cost(const Bssrdf& model, const Pairs& pairs) {
  const double start = cpu_seconds();
  double sum = 0;
  for (std::size_t i = 0; i < pairs.exits.size(); ++i)
    sum += model.evaluate(pairs.entries[i], pairs.exits[i]).g;
  CHECK(std::isfinite(sum));
  return 1e9 * (cpu_seconds() - start) / static_cast<double>(pairs.exits.size());
}

}  // namespace

TEST_CASE("cost of the shape basis per evaluation", "[.][bench][shape]") {
  for (const char* name : {"sphere_3", "blob", "torus", "slab_2"})
    for (const bool grey : {true, false}) {
      const MeshScene scene = load_mesh_scene(name, 48);
      const SceneObject& object = scene.scene.objects.front();
      Medium medium = *scene.scene.materials[object.mesh.materials.front()].medium;
      if (!grey) medium.mean_free_path *= Rgb(1.5, 1, 0.6);
      for (const char* model : {"homogeneous", "factorized", "aggregate", "composite"}) {
        const std::vector<uint8_t> boundary(scene.scene.materials.size(), 1);
        const BssrdfTransport plain(scene.scene, 0, medium, boundary, model, Basis::half_space);
        const BssrdfTransport shaped(scene.scene, 0, medium, boundary, model, Basis::shape);
        const ProbeSampler probe(shaped.model(), {&scene.scene.rays, &object.mesh, 0, boundary});
        // Few enough to stay in the cache, as in a render, where the points of a pair were just read.
        const Pairs pairs = draw_pairs(probe, object.mesh, 200, 4);
        double half_space = 1e9, shape = 1e9;
        for (int repeat = 0; repeat < 150; ++repeat) {
          half_space = std::min(half_space, cost(plain.model(), pairs));
          shape = std::min(shape, cost(shaped.model(), pairs));
        }
        std::printf("%-9s %-6s %-12s half-space %4.0f ns, shape %4.0f ns, %.2f times\n", name,
                    grey ? "grey" : "colour", model, half_space, shape, shape / half_space);
      }
    }
}
