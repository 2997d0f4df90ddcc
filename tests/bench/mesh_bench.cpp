// Time and memory of what is done once per mesh, at a million triangles:
//   build/release/tests/test_bench "[mesh]"

#include <fmt/format.h>
#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <functional>
#include <string>

#include "core/parallel.h"
#include "geometry/curvature.h"
#include "geometry/half_edge_mesh.h"
#include "geometry/ray_scene.h"
#include "geometry/shapes.h"
#include "geometry/uv_atlas.h"

using namespace alabaster;

namespace {

/// Resident memory now, bytes.
double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double total = 0, resident = 0;
  file >> total >> resident;
  return resident * 4096;
}

void measure(const char* name, std::size_t triangles, const std::function<void()>& work) {
  const double memory = resident_bytes(), cpu = cpu_seconds(), wall = wall_seconds();
  work();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("{:<28} {:6.2f} s CPU, {:6.2f} s wall, {:7.1f} bytes per triangle stay, peak so far {:.1f}\n",
             name, cpu_seconds() - cpu, wall_seconds() - wall,
             (resident_bytes() - memory) / static_cast<double>(triangles),
             1024.0 * static_cast<double>(usage.ru_maxrss) / static_cast<double>(triangles));
}

}  // namespace

TEST_CASE("a million triangles: time and memory", "[.][bench][mesh]") {
  TriangleMesh mesh;
  measure("mesh", 1000000, [&] { mesh = make_blob(1, 0.1, 1155); });
  const std::size_t count = mesh.triangle_count();
  fmt::print("{} triangles\n", count);
  MeshReport report;
  measure("clean_mesh", count, [&] { report = clean_mesh(mesh); });
  CHECK(report.closed);
  UvAtlas atlas;
  measure("UV atlas", count, [&] { atlas = UvAtlas(mesh); });
  RayScene scene;
  measure("ray scene", count, [&] {
    scene.add(mesh);
    scene.commit();
  });
  CurvatureField curvature;
  measure("curvature and thickness", count, [&] { curvature = CurvatureField(mesh, scene, 0); });
  measure("half-edges, for a while", count, [&] { const HalfEdgeMesh half_edges(mesh); });
}
