// The kernel's mean on whatever meshes and UVs there are: what must hold everywhere, and what happens where
// the idea of a kernel on the surface breaks down.

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "bssrdf/aggregation_kernel.h"
#include "bssrdf/body.h"
#include "geometry/shapes.h"
#include "support/uv_meshes.h"
#include "texture/material_map.h"
#include "texture/seam_gutters.h"
#include "texture/solid_texture.h"
#include "texture/surface_albedo.h"
#include "texture/vertex_albedo.h"

using namespace alabaster;

namespace {

constexpr int side = 128;

std::unique_ptr<AlbedoField> in_space(const TriangleMesh& mesh, std::unique_ptr<AlbedoField> field,
                                      double finest) {
  const auto pyramid = std::make_shared<const SurfacePyramid>(mesh, all_triangles(mesh), *field, finest);
  return std::make_unique<SurfaceAlbedo>(mesh, std::move(field), std::vector{pyramid});
}

/// As a scene prepares it: gutters, the texture's pyramid, the pyramid in space.
std::unique_ptr<AlbedoField> textured(const TriangleMesh& mesh, TexelArray texels) {
  const UvAtlas atlas(mesh);
  const auto triangles = all_triangles(mesh);
  Coverage coverage = texel_coverage(mesh, atlas, triangles, {}, texels.width, texels.height);
  const double size = texel_size(mesh, atlas, triangles, {}, texels.width, texels.height);
  fill_gutters(mesh, triangles, {}, texels, coverage);
  return in_space(mesh, std::make_unique<TextureAlbedo>(mesh, triangles, texels, coverage, TextureMapping{}),
                  finest_pyramid_sigma(mesh, triangles, size, side * side));
}

TexelArray texels_of(const std::function<float(int, int)>& value) {
  TexelArray texels{side, side, {}};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) texels.texels.emplace_back(value(x, y), value(x, y), value(x, y), 1);
  return texels;
}

double mean_between(const Body& body, const AlbedoField& field, const SurfacePoint& entry,
                    const SurfacePoint& exit) {
  PlacementBody parts = body.parts();
  parts.by_position_from = field.by_position_from();
  const ChordPlacement placement(parts);
  return aggregate_albedo(field, placement, entry, exit, glm::distance(entry.position, exit.position),
                          ek17_kernel)
      .r;
}

SurfacePoint nearest(const Body& body, const Vec3& p) {
  const auto found = body.rays.closest_point(0, p);
  return body.mesh.surface_point(found->triangle, found->barycentric);
}

struct NastyUvs {
  const char* name;
  std::function<void(TriangleMesh&)> change;
};

const std::vector<NastyUvs>& nasty_uvs() {
  const auto each = [](auto&& change) {
    return [change](TriangleMesh& mesh) {
      for (Vec2f& uv : mesh.uv_sets[0]) uv = change(uv);
    };
  };
  static const std::vector<NastyUvs> all{
      {"as they are", [](TriangleMesh&) {}},
      {"one NaN", [](TriangleMesh& m) { m.uv_sets[0][10].x = std::numeric_limits<float>::quiet_NaN(); }},
      {"all NaN", each([](Vec2f) { return Vec2f(std::numeric_limits<float>::quiet_NaN()); })},
      {"infinite", [](TriangleMesh& m) { m.uv_sets[0][20].y = -std::numeric_limits<float>::infinity(); }},
      {"no area", each([](Vec2f) { return Vec2f(0.3F); })},
      {"a line", each([](Vec2f uv) { return Vec2f(uv.x, 0.5F); })},
      {"mirrored onto itself", each([](Vec2f uv) { return Vec2f(std::abs(uv.x - 0.5F), uv.y); })},
      {"tiled", each([](Vec2f uv) { return 5.0F * uv - 2.0F; })},
      {"smaller than a texel", each([](Vec2f uv) { return 0.5F + 1e-3F * uv; })},
      {"huge", each([](Vec2f uv) { return 1e6F * uv; })},
      {"every triangle a chart", [](TriangleMesh& mesh) {
         std::vector<Vec2f> uvs;
         std::vector<Vec3f> normals;
         const auto cells =
             static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(mesh.triangle_count()))));
         for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
           for (std::size_t k = 0; k < 3; ++k) {
             const Vec2 place = std::array{Vec2(0.1, 0.1), Vec2(0.9, 0.1), Vec2(0.1, 0.9)}[k];
             normals.push_back(mesh.normals[mesh.attributes[t][k]]);
             uvs.emplace_back((Vec2(t % cells, t / cells) + place) / static_cast<double>(cells));
             mesh.attributes[t][k] = static_cast<uint32_t>(uvs.size() - 1);
           }
         mesh.uv_sets[0] = uvs, mesh.normals = normals;
       }}};
  return all;
}

}  // namespace

TEST_CASE("whatever the UVs, one albedo stays one and means stay among the values", "[bssrdf]") {
  for (const NastyUvs& nasty : nasty_uvs()) {
    TriangleMesh mesh = make_blob(1, 0.25, 16);
    nasty.change(mesh);
    const Body body(mesh);
    const auto constant = textured(body.mesh, texels_of([](int, int) { return 0.7F; }));
    const auto checks =
        textured(body.mesh, texels_of([](int x, int y) { return (x / 16 + y / 16) % 2 ? 0.9F : 0.2F; }));
    const auto points = points_on(body.mesh, 300, 7);
    CAPTURE(nasty.name);
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      // Near neighbours as well as far ones.
      const SurfacePoint other =
          k % 2 ? points[k + 1] : nearest(body, points[k].position + Vec3(0.03, -0.02, 0.04));
      if (glm::distance(other.position, points[k].position) < 1e-6) continue;
      REQUIRE(mean_between(body, *constant, points[k], other) == Approx(0.7).margin(1e-5));
      const double mean = mean_between(body, *checks, points[k], other);
      REQUIRE(mean > 0.2 - 1e-5);
      REQUIRE(mean < 0.9 + 1e-5);
    }
  }
}

TEST_CASE("without UVs means come from the vertices and from space, and meet", "[bssrdf]") {
  TriangleMesh mesh = make_blob(1, 0.25, 32);
  mesh.uv_sets.clear();
  const Body body(mesh);
  const auto value = [](const Vec3& p) { return 0.5 + 0.3 * std::sin(3 * p.x + p.y); };
  std::vector<Rgb> albedo(mesh.normals.size());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      albedo[mesh.attributes[t][k]] = Rgb(value(mesh.positions[mesh.corners[t][k]]));
  const auto field =
      in_space(body.mesh, std::make_unique<VertexAlbedo>(body.mesh, all_triangles(body.mesh), albedo), 0.05);
  // Along a pair that widens, the mean moves without a jump and stays near the values on the way.
  for (const SurfacePoint& exit : points_on(body.mesh, 30, 5)) {
    double last = -1;
    for (double d = 0.02; d < 0.6; d *= 1.03) {
      const SurfacePoint entry = nearest(body, exit.position + Vec3(d, 0.2 * d, 0));
      if (glm::distance(entry.position, exit.position) < 0.3 * d) continue;
      const double mean = mean_between(body, *field, entry, exit);
      CHECK(mean == Approx(value(0.5 * (entry.position + exit.position))).margin(0.03 + 0.35 * d));
      if (last >= 0) CHECK(std::abs(mean - last) < 0.08);  // closest points may jump a little
      last = mean;
    }
  }
}

TEST_CASE("through a thin slab both sides count alike", "[bssrdf]") {
  // Light from side to side meets as much of one as of the other: the medium's albedo is that of the nearer.
  const Body body(make_slab(2, 0.1, 24));
  const auto field = textured(
      body.mesh, bake_solid(body.mesh, side, side, [](const Vec3& p) { return Rgb(p.y > 0 ? 0.9 : 0.3); }));
  const SurfacePoint above = nearest(body, {0.1, 0.05, 0.1}), below = nearest(body, {0.1, -0.05, 0.1});
  // Means lie at 4/7, 2/7 and 1/7 of the way from the entry: nearer to it, so its side counts for a little
  // more.
  const double down = mean_between(body, *field, above, below), up = mean_between(body, *field, below, above);
  CHECK(down + up == Approx(1.2).margin(0.05));
  CHECK(down > 0.6);
  CHECK(down < 0.85);
  const SurfacePoint far = nearest(body, {0.9, -0.05, 0.1});
  CHECK(mean_between(body, *field, above, far) == Approx(0.6).margin(0.1));
}

TEST_CASE("across the gap of a fold a wide kernel counts both layers, a narrow one its own", "[bssrdf]") {
  // The gap is 0.1 wide. In space nobody can tell it from a slab: where the kernel is wider than the gap, the
  // mean counts the other layer. This is the limit of averages in space.
  const Body body(make_folded_sheet(2, 0.2, 0.1, 32));
  const auto field = textured(
      body.mesh, bake_solid(body.mesh, side, side, [](const Vec3& p) { return Rgb(p.y > 0 ? 0.9 : 0.3); }));
  const SurfacePoint a = nearest(body, {0.2, 0.05, 0}), b = nearest(body, {0.24, 0.05, 0.03}),
                     c = nearest(body, {0.6, 0.05, 0.4}), opposite = nearest(body, {0.2, -0.05, 0});
  REQUIRE(a.geometric_normal.y < -0.9);
  REQUIRE(opposite.geometric_normal.y > 0.9);
  CHECK(mean_between(body, *field, a, b) == Approx(0.9).margin(0.02));
  const double wide = mean_between(body, *field, a, c);
  CHECK(wide > 0.55);
  CHECK(wide < 0.9);
  const double across = mean_between(body, *field, a, opposite);
  CHECK(across > 0.3);
  CHECK(across < 0.9);
}

TEST_CASE("what a Gaussian sees across a gap is the far layer's share of it in space", "[bssrdf]") {
  // Layers 0.2 thick, 0.1 apart: faces at heights 0.05 and 0.25 above the middle and below it. A plane at a
  // distance d counts exp(-d^2 / 2 sigma^2).
  const Body body(make_folded_sheet(2, 0.2, 0.1, 32));
  const auto field = textured(
      body.mesh, bake_solid(body.mesh, side, side, [](const Vec3& p) { return Rgb(p.y > 0 ? 0.9 : 0.3); }));
  const SurfacePoint inside = nearest(body, {0.2, 0.05, 0});
  const double from =
      field->by_position_from();  // narrower ones are the texture's, which knows its own layer
  REQUIRE(from < 0.08);
  CHECK(field->filtered(body.placement.around(inside, 0.7 * from, Vec3(0))).r == Approx(0.9).margin(1e-5));
  for (const double sigma : {from, 0.08, 0.1, 0.2}) {
    const auto plane = [&](double d) { return std::exp(-0.5 * d * d / (sigma * sigma)); };
    const double own = 1 + plane(0.2), far = plane(0.1) + plane(0.3);
    CAPTURE(sigma, far / (own + far));
    CHECK(field->filtered(body.placement.around(inside, sigma, Vec3(0))).r ==
          Approx((0.9 * own + 0.3 * far) / (own + far)).margin(0.02));
  }
}

TEST_CASE("mirrored and tiled textures average to what the surface shows", "[bssrdf]") {
  // Waves along u; the truth is an integral over x. Texels are 0.02 and 0.0026 m.
  struct Case {
    const char* name;
    std::function<Vec2(const Vec3&)> uv;
    int waves;
  };
  const Case cases[] = {
      {"mirrored", [](const Vec3& p) { return Vec2(0.1 + 0.4 * std::abs(p.x), 0.5 + 0.4 * p.y); }, 5},
      {"tiled", [](const Vec3& p) { return Vec2(3.0 * p.x, 3.0 * p.y); }, 2}};
  for (const Case& c : cases) {
    TriangleMesh mesh = make_plane(2, 64);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        mesh.uv_sets[0][mesh.attributes[t][k]] = Vec2f(c.uv(mesh.positions[mesh.corners[t][k]]));
    const Body body(mesh);
    const auto value = [&](double u) { return 0.5 + 0.4 * std::sin(2 * pi * c.waves * u + 1); };
    const auto field = textured(
        body.mesh, texels_of([&](int x, int) { return static_cast<float>(value((x + 0.5) / side)); }));
    Rng rng(4);
    for (const double sigma : {0.01, 0.02, 0.04, 0.08, 0.16}) {
      double worst = 0, squared = 0;
      constexpr int count = 60;
      for (int n = 0; n < count; ++n) {
        const SurfacePoint p = nearest(body, {0.4 * rng.uniform() - 0.2, 0.4 * rng.uniform() - 0.2, 0});
        double exact = 0, weight = 0;
        for (int i = -200; i <= 200; ++i) {
          const double offset = 0.02 * i, w = std::exp(-0.5 * offset * offset);
          exact += w * value(c.uv(p.position + Vec3(sigma * offset, 0, 0)).x), weight += w;
        }
        const double error =
            std::abs(field->filtered(body.placement.around(p, sigma, Vec3(0))).r - exact / weight) / 0.8;
        worst = std::max(worst, error), squared += error * error / count;
      }
      CAPTURE(c.name, sigma);
      CHECK(std::sqrt(squared) < 0.012);  // as the pyramid over space has it on a plane
      CHECK(worst < 0.035);
    }
  }
}

TEST_CASE("a kernel wider than its chart counts the charts around it", "[bssrdf]") {
  // Six charts, one of them dark: from its middle, means must brighten as the kernel outgrows it.
  const Body body(make_blob(1, 0, 48));
  const auto field = textured(body.mesh, bake_solid(body.mesh, side, side, [](const Vec3& p) {
                                return Rgb(p.x > std::max(std::abs(p.y), std::abs(p.z)) ? 0.2 : 0.8);
                              }));
  KernelFootprint f;
  const SurfacePoint middle = nearest(body, {1, 0.01, 0.02});
  f.position = middle.position, f.triangle = middle.triangle, f.uv = middle.uv,
  f.barycentric = middle.barycentric;
  double last = 0;
  for (const double sigma : {0.2, 0.4, 0.6, 0.9, 1.4}) {
    f.sigma = sigma;
    const double mean = field->filtered(f).r;
    CHECK(mean > last);
    last = mean;
  }
  f.sigma = 0.2;
  CHECK(field->filtered(f).r == Approx(0.2).margin(0.01));
  CHECK(last > 0.6);
}
