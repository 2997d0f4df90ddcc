// Error against cost of the geodesic methods, pairs of a kernel's size (a tenth of the radius) and larger:
//   build/release/tests/test_bench "[geodesic]"

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "core/parallel.h"
#include "core/rng.h"
#include "geometry/geodesic.h"
#include "geometry/shapes.h"

using namespace alabaster;

namespace {

using Exact = std::function<double(const Vec3&, const Vec3&)>;
using Pairs = std::vector<std::pair<SurfacePoint, SurfacePoint>>;

SurfacePoint random_point(const TriangleMesh& mesh, Rng& rng) {
  const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
  const double r = std::sqrt(rng.uniform());
  return mesh.surface_point(t, {r * rng.uniform(), 1 - r});
}

/// Pairs whose true distance lies between the bounds.
Pairs random_pairs(const TriangleMesh& mesh, const Exact& exact, double low, double high, std::size_t count) {
  Rng rng(31);
  Pairs pairs;
  while (pairs.size() < count) {
    const SurfacePoint a = random_point(mesh, rng), b = random_point(mesh, rng);
    const double distance = exact(a.position, b.position);
    if (distance >= low && distance <= high) pairs.emplace_back(a, b);
  }
  return pairs;
}

void measure(const Geodesic& method, const Pairs& pairs, const Exact& exact) {
  double mean = 0, bias = 0, worst = 0;
  int answered = 0;
  const double start = cpu_seconds();
  std::vector<std::optional<double>> distances;
  for (const auto& [a, b] : pairs) distances.push_back(method.distance(a, b));
  const double seconds = cpu_seconds() - start;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!distances[i]) continue;
    const double error = *distances[i] / exact(pairs[i].first.position, pairs[i].second.position) - 1;
    ++answered, bias += error, mean += std::abs(error), worst = std::max(worst, std::abs(error));
  }
  const double n = std::max(answered, 1);
  fmt::print(
      "  {:<24} mean error {:8.4f} %, bias {:8.4f} %, worst {:8.4f} %, refused {:3d}, {:10.2f} us/query\n",
      method.name(), 100 * mean / n, 100 * bias / n, 100 * worst, static_cast<int>(pairs.size()) - answered,
      1e6 * seconds / static_cast<double>(pairs.size()));
  CHECK(answered > 0);
}

void measure_all(const char* name, const TriangleMesh& mesh, const Exact& exact) {
  const HalfEdgeMesh half_edges(mesh);
  RayScene scene;
  scene.add(mesh);
  scene.commit();
  std::vector<std::unique_ptr<Geodesic>> methods;
  methods.push_back(make_chord(mesh, scene, 0));
  methods.push_back(make_normal_corrected_chord(mesh, scene, 0));
  methods.push_back(make_projected_chord(mesh, scene, 0));
  methods.push_back(make_straightest_path(mesh, half_edges));
  methods.push_back(make_edge_graph(mesh, half_edges));
  const double start = cpu_seconds();
  methods.push_back(make_heat_method(mesh, half_edges));
  fmt::print("{}, {} triangles (heat method's factorisation {:.2f} s)\n", name, mesh.triangle_count(),
             cpu_seconds() - start);
  for (const auto& [low, high] : {std::pair{0.05, 0.15}, std::pair{0.5, 1.5}}) {
    fmt::print(" distances {} to {}\n", low, high);
    const Pairs pairs = random_pairs(mesh, exact, low, high, 100);
    for (const auto& method : methods) measure(*method, pairs, exact);
  }
}

}  // namespace

TEST_CASE("geodesic methods: error and cost", "[.][bench][geodesic]") {
  measure_all("plane, size 2", make_plane(2, 64),
              [](const Vec3& a, const Vec3& b) { return glm::length(a - b); });
  measure_all("unit sphere", make_blob(1, 0, 128), [](const Vec3& a, const Vec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
  });
  measure_all("unit cylinder", make_cylinder(1, 4, 128), [](const Vec3& a, const Vec3& b) {
    if (std::max(std::abs(a.y), std::abs(b.y)) > 1.9) return std::numeric_limits<double>::quiet_NaN();
    const double angle = std::abs(std::remainder(std::atan2(a.z, a.x) - std::atan2(b.z, b.x), 2 * pi));
    return std::hypot(angle, a.y - b.y);
  });
}
