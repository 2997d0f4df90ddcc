#include "texture/coverage.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/rng.h"
#include "support/uv_meshes.h"

using namespace alabaster;

namespace {

Coverage cover(const TriangleMesh& mesh, int width, int height, const TextureMapping& mapping = {}) {
  return texel_coverage(mesh, UvAtlas(mesh, 0), all_triangles(mesh), mapping, width, height);
}

double total(const Coverage& coverage) {
  return std::accumulate(coverage.weights.begin(), coverage.weights.end(), 0.0);
}

}  // namespace

TEST_CASE("a texel counts when its centre is inside") {
  // The triangle (0, 0), (1, 0), (0, 1) on 4 x 4 texels: centres with x + y <= 1.
  const TriangleMesh mesh = uv_mesh({{{0, 0}, {1, 0}, {0, 1}}});
  const Coverage coverage = cover(mesh, 4, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      CHECK(coverage.weights[static_cast<std::size_t>(4 * y + x)] == (x + y <= 3 ? 1.0f : 0.0f));
  CHECK(coverage.untexeled.empty());
}

TEST_CASE("coverage agrees with a point-in-triangle test at every centre") {
  Rng rng(3);
  for (int n = 0; n < 200; ++n) {
    Vec2 uv[3];
    for (Vec2& p : uv) p = Vec2(rng.uniform(), rng.uniform());
    const Coverage coverage = cover(uv_mesh({{uv[0], uv[1], uv[2]}}), 31, 17);
    const Vec2 ab = uv[1] - uv[0], ac = uv[2] - uv[0];
    const double area = ab.x * ac.y - ab.y * ac.x;
    double sum = total(coverage);
    for (int y = 0; y < 17; ++y)
      for (int x = 0; x < 31; ++x) {
        const Vec2 p = Vec2((x + 0.5) / 31, (y + 0.5) / 17) - uv[0];
        const double b = (p.x * ac.y - p.y * ac.x) / area, c = (ab.x * p.y - ab.y * p.x) / area;
        const double inside = std::min({b, c, 1 - b - c});
        if (std::abs(inside) < 1e-4 || sum < 1) continue;
        REQUIRE((coverage.weights[static_cast<std::size_t>(31 * y + x)] == 1) == (inside > 0));
      }
  }
}

TEST_CASE("tiled, mirrored and clamped UVs land on the texels they show") {
  const TriangleMesh shifted = uv_mesh({{{2.0, -3.0}, {2.5, -3.0}, {2.0, -2.5}}});
  const Coverage base = cover(uv_mesh({{{0, 0}, {0.5, 0}, {0, 0.5}}}), 16, 16);
  CHECK(cover(shifted, 16, 16).weights == base.weights);
  TextureMapping mirror;
  mirror.wrap_u = mirror.wrap_v = Wrap::mirror;
  CHECK(cover(uv_mesh({{{2.0, 0.0}, {1.5, 0.0}, {2.0, -0.5}}}), 16, 16, mirror).weights == base.weights);
  TextureMapping clamp;
  clamp.wrap_u = clamp.wrap_v = Wrap::clamp;
  const Coverage edge = cover(uv_mesh({{{1.2, 0}, {1.9, 0}, {1.2, 1}}}), 8, 8, clamp);
  for (int y = 0; y < 5; ++y) {
    CHECK(edge.weights[static_cast<std::size_t>(8 * y + 7)] == 1);
    CHECK(edge.weights[static_cast<std::size_t>(8 * y + 6)] == 0);
  }
  TextureMapping transformed;
  transformed.scale = {0.5, 0.5};
  CHECK(cover(uv_mesh({{{0, 0}, {1, 0}, {0, 1}}}), 16, 16, transformed).weights == base.weights);
}

TEST_CASE("a palette: triangles shrunk onto a spot keep the texels they touch") {
  const Coverage point = cover(uv_mesh({{{0.3, 0.3}, {0.3, 0.3}, {0.3, 0.3}}}), 8, 8);
  CHECK(point.untexeled.empty());
  CHECK(total(point) == Approx(0.001));
  CHECK(point.weights[2 * 8 + 2] > 0);
  const Coverage tiny = cover(uv_mesh({{{0.26, 0.26}, {0.30, 0.26}, {0.26, 0.30}}}), 8, 8);
  CHECK(total(tiny) == Approx(0.5 * 0.32 * 0.32));
}

TEST_CASE("a splinter of an atlas borrows from its neighbour on the surface") {
  // Two triangles that share an edge in space and have the same texel density; the second, a sliver, lies in
  // UV between the centres.
  TriangleMesh mesh = uv_mesh({{{0, 0}, {0.5, 0}, {0, 0.5}}, {{0.89, 0.8}, {0.89, 0.85}, {0.9, 0.8}}});
  mesh.positions = {{0, 0, 0}, {5, 0, 0}, {0, 5, 0}, {-0.1, 0, 0}};
  mesh.corners = {{0, 1, 2}, {0, 2, 3}};
  const Coverage coverage = cover(mesh, 8, 8);
  REQUIRE(coverage.untexeled == std::vector<uint32_t>{1});
  CHECK(coverage.weights[6 * 8 + 7] == 0);
  const auto substitutes = substitute_uvs(mesh, all_triangles(mesh), coverage.untexeled, 0);
  const Vec2 uv = substitutes.at(1);
  CHECK(uv.x == Approx(0).margin(1e-6));
  CHECK(uv.y == Approx(0.5 / 3).epsilon(1e-3));
}

TEST_CASE("broken UVs are left out") {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, 1e20}) {
    const Coverage coverage = cover(uv_mesh({{{0, 0}, {bad, 0}, {0, 1}}, {{0, 0}, {1, 0}, {0, 1}}}), 8, 8);
    CHECK(coverage.untexeled == std::vector<uint32_t>{0});
    CHECK(total(coverage) == 36);
  }
}
