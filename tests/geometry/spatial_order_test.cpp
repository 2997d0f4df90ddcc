#include "geometry/spatial_order.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>

#include "geometry/shapes.h"

using namespace alabaster;

namespace {

// All that a triangle's corners say.
using Corner = std::array<double, 8>;
using Triangle = std::array<Corner, 3>;

std::vector<Triangle> triangles(const TriangleMesh& mesh) {
  std::vector<Triangle> result;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = mesh.positions[mesh.corners[t][k]];
      const uint32_t attribute = mesh.attributes.empty() ? mesh.corners[t][k] : mesh.attributes[t][k];
      const Vec3f& n = mesh.normals[attribute];
      const Vec2f uv = mesh.uv_sets.empty() ? Vec2f(0) : mesh.uv_sets[0][attribute];
      triangle[k] = {p.x, p.y, p.z, double{n.x}, double{n.y}, double{n.z}, double{uv.x}, double{uv.y}};
    }
    result.push_back(triangle);
  }
  return result;
}

double mean_step(const TriangleMesh& mesh) {
  double sum = 0;
  for (uint32_t t = 1; t < mesh.triangle_count(); ++t)
    sum += glm::distance(mesh.position(t - 1, Vec2(1.0 / 3)), mesh.position(t, Vec2(1.0 / 3)));
  return sum / static_cast<double>(mesh.triangle_count() - 1);
}

// How far apart in memory the corners of a triangle are, on average.
double index_spread(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Index3& c : mesh.corners) {
    const auto [low, high] = std::minmax({c[0], c[1], c[2]});
    sum += high - low;
  }
  return sum / static_cast<double>(mesh.triangle_count());
}

}  // namespace

TEST_CASE("sorting in space changes the order of triangles and nothing else", "[geometry]") {
  for (const bool shared : {false, true}) {
    TriangleMesh mesh = make_blob(1, 0.2, 64);
    if (shared) {
      mesh.uv_sets.clear();
      mesh.attributes.clear();
      mesh.normals.clear();
      for (const Vec3& p : mesh.positions) mesh.normals.emplace_back(glm::normalize(p));
    }
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) mesh.materials[t] = t % 3 == 0;
    mesh.positions.push_back(Vec3(7));  // that nothing uses
    TriangleMesh sorted = mesh;
    sort_in_space(sorted);
    CHECK(sorted.positions.size() == mesh.positions.size() - 1);
    CHECK(std::count(sorted.materials.begin(), sorted.materials.end(), 1) ==
          std::count(mesh.materials.begin(), mesh.materials.end(), 1));
    std::vector<Triangle> before = triangles(mesh), after = triangles(sorted);
    CHECK(before != after);
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    CHECK(before == after);
    CHECK(index_spread(sorted) < index_spread(mesh));
    CHECK(mean_step(sorted) < 3 * std::sqrt(surface_area(mesh) / static_cast<double>(mesh.triangle_count())));
  }
}
