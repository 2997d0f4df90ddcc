#include "bssrdf/smoothed_normals.h"

#include <catch2/catch.hpp>
#include <utility>

#include "geometry/shapes.h"

using namespace alabaster;

TEST_CASE("smoothed normals see the body, not its bumps", "[bssrdf]") {
  const TriangleMesh blob = make_blob(1, 0.25, 96);
  const auto mean_cosine = [&](double scale) {
    const auto normals = smoothed_normals(blob, scale);
    double sum = 0;
    for (uint32_t t = 0; t < blob.triangle_count(); ++t)
      sum += glm::dot(Vec3(normals[t]), glm::normalize(blob.position(t, Vec2(1.0 / 3))));
    return sum / static_cast<double>(blob.triangle_count());
  };
  CHECK(mean_cosine(0.5) > 0.97);
  CHECK(mean_cosine(0.5) > mean_cosine(1e-4));
}

TEST_CASE("smoothed normals are the triangle's own where nothing else agrees", "[bssrdf]") {
  // A sheet a hundredth of the scale thick: its two sides cancel. Scales of nothing see nothing.
  for (const auto& [mesh, scale] : {std::pair(make_slab(2, 0.002, 16), 0.2),
                                    std::pair(make_sphere(1, 24), 0.0), std::pair(make_plane(3, 4), 0.7)}) {
    const auto normals = smoothed_normals(mesh, scale);
    REQUIRE(normals.size() == mesh.triangle_count());
    int own = 0;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      CHECK(glm::length(normals[t]) == Approx(1).epsilon(1e-5));
      own += glm::dot(Vec3(normals[t]), mesh.geometric_normal(t)) > 1 - 1e-6;
    }
    CHECK(own >= 0.8 * static_cast<double>(mesh.triangle_count()));
  }
}
