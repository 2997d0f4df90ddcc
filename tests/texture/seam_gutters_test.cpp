#include "texture/seam_gutters.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/frame.h"
#include "core/rng.h"
#include "geometry/shapes.h"
#include "support/uv_meshes.h"
#include "texture/material_map.h"
#include "texture/solid_texture.h"

using namespace alabaster;

namespace {

constexpr int side = 256;

/// A textured mesh with its gutters filled.
struct Textured {
  Textured(const TriangleMesh& given, TexelArray colours, const TextureMapping& mapping = {},
           double reach = 16)
      : mesh(given), atlas(mesh), texels(std::move(colours)) {
    const auto triangles = all_triangles(mesh);
    coverage = texel_coverage(mesh, atlas, triangles, mapping, texels.width, texels.height);
    before = coverage.weights;
    filled = fill_gutters(mesh, triangles, mapping, texels, coverage, reach);
    field = std::make_unique<TextureAlbedo>(mesh, triangles, texels, coverage, mapping);
  }
  Rgb filtered(uint32_t triangle, Vec2 barycentric, double sigma) const {
    const SurfacePoint p = mesh.surface_point(triangle, barycentric);
    const Frame frame(p.geometric_normal);
    return field->filtered(
        {p.uv,
         barycentric,
         triangle,
         sigma,
         {atlas.uv_from_surface(triangle, frame.tangent), atlas.uv_from_surface(triangle, frame.bitangent)},
         p.position});
  }

  TriangleMesh mesh;
  UvAtlas atlas;
  TexelArray texels;
  Coverage coverage;
  std::vector<float> before;
  std::size_t filled = 0;
  std::unique_ptr<TextureAlbedo> field;
};

TexelArray flat_texels(const Rgb& value) {
  return {side, side, std::vector<Vec4f>(std::size_t{side} * side, Vec4f(value.r, value.g, value.b, 1))};
}

/// A plane in the z = 0 plane cut into two charts at x = 0, the right one turned by a quarter and moved.
TriangleMesh cut_plane() {
  TriangleMesh mesh = make_plane(2, 8);
  std::vector<Vec2f>& uvs = mesh.uv_sets[0];
  std::vector<Vec3f>& normals = mesh.normals;
  const std::size_t count = uvs.size();
  uvs.resize(2 * count), normals.resize(2 * count, normals[0]);
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const bool right = mesh.position(t, Vec2(1.0 / 3)).x > 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = mesh.positions[mesh.corners[t][k]];
      uint32_t& a = mesh.attributes[t][k];
      if (right) a = static_cast<uint32_t>(a + count);
      // 0.35 of the texture's side per metre; gutters of 0.1 between and around.
      uvs[a] = right ? Vec2f(static_cast<float>(0.3 + 0.2 * p.y), static_cast<float>(0.6 + 0.2 * p.x))
                     : Vec2f(static_cast<float>(0.4 + 0.2 * p.x), static_cast<float>(0.3 + 0.2 * p.y));
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("beyond the seam of a cut plane the gutter continues the picture") {
  const auto value = [](const Vec3& p) { return Rgb(0.5 + 0.2 * p.x + 0.1 * p.y, 0.4 - 0.2 * p.y, 0.3); };
  const TriangleMesh mesh = cut_plane();
  TexelArray texels = flat_texels(Rgb(1, 0, 1));
  for_each_covered_texel(mesh, all_triangles(mesh), {}, side, side, [&](std::size_t i, uint32_t t, Vec2 b) {
    const Rgb c = value(mesh.position(t, b));
    texels.texels[i] = Vec4f(c.r, c.g, c.b, 1);
  });
  const Textured cut(mesh, texels, {}, 12);
  const double per_metre = 0.2 * side;
  int checked = 0;
  for (int y = 0, i = 0; y < side; ++y)
    for (int x = 0; x < side; ++x, ++i) {
      const auto n = static_cast<std::size_t>(i);
      if (cut.before[n] > 0 || !(cut.coverage.weights[n] > 0)) continue;
      // Back from the left chart's place, or the right one's.
      const Vec2 uv = Vec2(x + 0.5, y + 0.5) / double{side};
      const Vec3 left((uv.x - 0.4) / 0.2, (uv.y - 0.3) / 0.2, 0),
          right((uv.y - 0.6) / 0.2, (uv.x - 0.3) / 0.2, 0);
      const bool of_left = left.x > -1e-9 && left.x < 13 / per_metre && std::abs(left.y) < 1;
      const bool of_right = right.x < 1e-9 && right.x > -13 / per_metre && std::abs(right.y) < 1;
      REQUIRE((of_left || of_right));
      if (of_left && of_right) continue;
      const Vec3 p = of_left ? left : right;
      const Rgb expected = value(p);
      ++checked;
      // One-sided at the far chart's own border: up to a texel off.
      CHECK(static_cast<double>(cut.texels.texels[n].x) == Approx(expected.r).margin(0.2 / per_metre));
      CHECK(static_cast<double>(cut.texels.texels[n].y) == Approx(expected.g).margin(0.2 / per_metre));
    }
  CHECK(checked > 1500);
  // And so does an average across it: a linear picture stays what it is.
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 p = mesh.position(t, {0.3, 0.3});
    if (std::abs(p.x) > 0.12 || std::abs(p.y) > 0.6) continue;
    CHECK(cut.filtered(t, {0.3, 0.3}, 0.07).r == Approx(value(p).r).margin(0.002));
  }
}

TEST_CASE("one albedo in a shattered atlas stays one, at every width") {
  // Every triangle a chart of its own, in a grid of cells with gutters.
  TriangleMesh mesh = make_blob(1, 0.25, 12);
  const auto cells = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(mesh.triangle_count()))));
  std::vector<Vec2f> uvs;
  std::vector<Vec3f> normals;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec2 corner = Vec2(t % cells, t / cells) / static_cast<double>(cells);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 place = std::array{Vec2(0.2, 0.2), Vec2(0.8, 0.2), Vec2(0.2, 0.8)}[k];
      normals.push_back(mesh.normals[mesh.attributes[t][k]]);
      mesh.attributes[t][k] = static_cast<uint32_t>(uvs.size());
      uvs.push_back(Vec2f(corner + place / static_cast<double>(cells)));
    }
  }
  mesh.uv_sets[0] = uvs;
  mesh.normals = normals;
  const Rgb albedo(0.3, 0.6, 0.9);
  Textured shattered(mesh, [&] {
    TexelArray texels = flat_texels(Rgb(1, 0, 1));
    for_each_covered_texel(mesh, all_triangles(mesh), {}, side, side, [&](std::size_t i, uint32_t, Vec2) {
      texels.texels[i] = Vec4f(0.3F, 0.6F, 0.9F, 1);
    });
    return texels;
  }());
  CHECK(shattered.atlas.chart_count() == mesh.triangle_count());
  CHECK(shattered.filled > 1000);
  Rng rng(1);
  for (int n = 0; n < 5000; ++n) {
    const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
    const Rgb value = shattered.filtered(t, {0.5 * rng.uniform(), 0.5 * rng.uniform()},
                                         0.001 * std::exp(7 * rng.uniform()));
    for (int c = 0; c < 3; ++c) REQUIRE(value[c] == Approx(albedo[c]).margin(1e-5));
  }
}

TEST_CASE("filled gutters make averages at a seam what they are elsewhere") {
  const TriangleMesh mesh = make_blob(1, 0.25, 48);
  const TexelArray texels = bake_solid(mesh, side, side, [](const Vec3& p) {
    return Rgb(0.5 + 0.3 * std::sin(9 * p.x) * std::cos(8 * p.y + 1) * std::sin(7 * p.z + 2));
  });
  const Textured with(mesh, texels), without(mesh, texels, {}, 0);
  CHECK(with.filled > 5000);
  CHECK(without.filled < 100);
  // Across a seam's edge, the two sides should agree.
  double gap_with = 0, gap_without = 0;
  int count = 0;
  for (const UvSeam& seam : find_uv_seams(mesh)) {
    const auto middle = [&](uint32_t side_index) {
      Vec2 b(0);
      for (const uint32_t k : {side_index, (side_index + 1) % 3})
        if (k > 0) b[static_cast<int>(k - 1)] = 0.5;
      return b;
    };
    const double sigma = 0.025;  // 1.4 texels: the gutters here are four wide
    const auto gap = [&](const Textured& t) {
      return std::abs(t.filtered(seam.triangle, middle(seam.side), sigma).r -
                      t.filtered(seam.other_triangle, middle(seam.other_side), sigma).r);
    };
    gap_with += gap(with), gap_without += gap(without), ++count;
  }
  CAPTURE(gap_with / count, gap_without / count);
  CHECK(gap_with < 0.4 * gap_without);
}

TEST_CASE("gutters of nasty UVs: nothing breaks, nothing is made up") {
  const auto quadrants = [] {
    TexelArray texels = flat_texels(Rgb(1, 0, 1));
    return texels;
  }();
  const double bad = std::numeric_limits<double>::quiet_NaN();
  const auto spoilt = [&](auto&& change) {
    TriangleMesh mesh = make_slab(1, 0.2, 4);
    change(mesh.uv_sets[0]);
    return mesh;
  };
  const std::vector<TriangleMesh> meshes{
      spoilt([&](std::vector<Vec2f>& uvs) { uvs[3].x = static_cast<float>(bad); }),
      spoilt([&](std::vector<Vec2f>& uvs) { uvs[7].y = std::numeric_limits<float>::infinity(); }),
      spoilt([](std::vector<Vec2f>& uvs) { std::fill(uvs.begin(), uvs.end(), Vec2f(0.5F)); }),  // no area
      spoilt([](std::vector<Vec2f>& uvs) {
        for (Vec2f& uv : uvs) uv *= 7.0F;
      }),  // tiled
      spoilt([](std::vector<Vec2f>& uvs) {
        for (Vec2f& uv : uvs) uv.x = std::abs(uv.x - 0.5F);
      }),  // mirrored
      spoilt([](std::vector<Vec2f>& uvs) {
        for (Vec2f& uv : uvs) uv = 1e-4F * uv;
      }),  // less than a texel
      spoilt([](std::vector<Vec2f>& uvs) {
        for (Vec2f& uv : uvs) uv = 1e7F * uv;
      })};
  for (const TriangleMesh& mesh : meshes)
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
      TextureMapping mapping;
      mapping.wrap_u = mapping.wrap_v = wrap;
      const Textured textured(mesh, quadrants, mapping);
      for (const Vec4f& texel : textured.texels.texels) REQUIRE(texel == Vec4f(1, 0, 1, 1));
      for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
        REQUIRE(textured.filtered(t, {0.3, 0.3}, 0.05).is_finite());
    }
}
