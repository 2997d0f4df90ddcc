#include "texture/material_map.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "core/rng.h"
#include "support/uv_meshes.h"

using namespace alabaster;

namespace {

// A unit square of two triangles; UV = position.
TriangleMesh square() {
  return uv_mesh({{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}});
}

TexelArray noise(int size) {
  TexelArray texels{size, size, {}};
  Rng rng(6);
  for (int i = 0; i < size * size; ++i)
    texels.texels.emplace_back(Vec4(rng.uniform(), rng.uniform(), rng.uniform(), 1));
  return texels;
}

TextureAlbedo field_of(const TriangleMesh& mesh, const TexelArray& texels, const TextureMapping& mapping) {
  const auto triangles = all_triangles(mesh);
  const UvAtlas atlas(mesh, mapping.uv_set);
  return TextureAlbedo(mesh, triangles, texels,
                       texel_coverage(mesh, atlas, triangles, mapping, texels.width, texels.height), mapping);
}

double distance(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

}  // namespace

TEST_CASE("reflectance becomes albedo texel by texel, clamped and counted") {
  TexelArray reflectance{2, 2, {{0.5f, 0.25f, 0, 1}, {1, 1, 1, 1}, {0.99f, 0.5f, NAN, 1}, {-1, 0, 0, 1}}};
  const auto square_root = [](double r, int channel) { return channel == 2 ? r : std::sqrt(r); };
  const AlbedoTexels all = albedo_texels(reflectance, Rgb(0.9, 1, 1), {}, square_root);
  CHECK(all.clamped == 1);
  CHECK(all.texels.at(0, 0).x == Approx(std::sqrt(0.45)));
  CHECK(all.texels.at(0, 0).y == Approx(0.5));
  CHECK(all.texels.at(1, 0).x == Approx(std::sqrt(0.9)));
  CHECK(all.texels.at(1, 0).z == Approx(0.98));
  CHECK(all.texels.at(0, 1).z == 0);
  CHECK(all.texels.at(1, 1).x == 0);
  const std::vector<float> weights{1, 0, 1, 1};
  CHECK(albedo_texels(reflectance, Rgb(0.9, 1, 1), weights, square_root).clamped == 0);
}

TEST_CASE("an albedo field agrees with the texture it is made of, through every mapping") {
  TriangleMesh mesh = square();
  mesh.uv_sets.push_back(mesh.uv_sets[0]);
  for (Vec2f& uv : mesh.uv_sets[1]) uv = Vec2f(1.5f * uv.y + 0.1f, 0.7f * uv.x - 0.3f);
  Rng rng(1);
  for (int n = 0; n < 24; ++n) {
    TextureMapping mapping;
    mapping.wrap_u = static_cast<Wrap>(n % 3);
    mapping.wrap_v = static_cast<Wrap>(n / 3 % 3);
    mapping.filter = n % 2 ? Filter::linear : Filter::nearest;
    mapping.uv_set = n % 4 == 3 ? 1 : 0;
    mapping.offset = {rng.uniform(), rng.uniform()};
    mapping.scale = {1.3, 0.8 + rng.uniform()};
    mapping.rotation = n > 12 ? 0.4 : 0;
    const TexelArray texels = noise(8);
    const Texture texture(std::make_shared<TexelArray>(texels), mapping);
    const TextureAlbedo field = field_of(mesh, texels, mapping);
    for (int i = 0; i < 100; ++i) {
      // Away from the border, where texels with uncovered centres are left out of the field.
      const Vec2 p = 0.2 + 0.6 * Vec2(rng.uniform(), rng.uniform());
      const uint32_t triangle = p.x > p.y ? 0 : 1;
      const Vec2 barycentric = triangle == 0 ? Vec2(p.x - p.y, p.y) : Vec2(p.x, p.y - p.x);
      const SurfacePoint point = mesh.surface_point(triangle, barycentric);
      const Vec4 expected = texture.evaluate(mesh.uv(triangle, barycentric, mapping.uv_set));
      REQUIRE(distance(field.at(point), Rgb(expected.x, expected.y, expected.z)) < 1e-4);
    }
  }
}

TEST_CASE("footprints in metres become the right Gaussian in texels") {
  // The same texture on a plane of 2 m: sigma 0.1 m is 0.05 in UV.
  TriangleMesh mesh = square();
  const TexelArray texels = noise(64);
  const GaussianPyramid pyramid(texels, {}, Wrap::repeat, Wrap::repeat);
  const TextureAlbedo field = field_of(mesh, texels, {});
  KernelFootprint footprint;
  footprint.uv = {0.3, 0.6};
  footprint.triangle = 1;
  footprint.barycentric = {0.3, 0.3};
  footprint.sigma = 0.1;
  footprint.uv_from_surface = Mat2(0, 0.5, -0.5, 0);  // turned by 90 degrees
  CHECK(distance(field.filtered(footprint), pyramid.filtered({0.3, 0.6}, 0.05 * 64)) < 1e-6);

  // Through a transform that doubles the UVs, and through a second UV set that does the same.
  TextureMapping doubled;
  doubled.scale = {2, 2};
  const Rgb expected = pyramid.filtered({0.6, 1.2}, 0.1 * 64);
  CHECK(distance(field_of(mesh, texels, doubled).filtered(footprint), expected) < 1e-6);
  mesh.uv_sets.push_back(mesh.uv_sets[0]);
  for (Vec2f& uv : mesh.uv_sets[1]) uv *= 2.0f;
  TextureMapping second;
  second.uv_set = 1;
  CHECK(distance(field_of(mesh, texels, second).filtered(footprint), expected) < 1e-5);
  footprint.sigma = 0;
  CHECK(distance(field.filtered(footprint), pyramid.at({0.3, 0.6})) < 1e-6);
}

TEST_CASE("vertex colours are baked into the texels, shared texels get the mean") {
  TriangleMesh mesh = square();
  mesh.colours = {{0, 0, 0, 1}, {1, 0, 0, 1}, {1, 1, 0, 1}, {0, 0, 0, 1}, {1, 1, 0, 1}, {0, 1, 0, 1}};
  TexelArray texels{16, 16, std::vector<Vec4f>(256, Vec4f(0.5f, 0.5f, 0.5f, 1))};
  CHECK(bake_vertex_colours(mesh, all_triangles(mesh), {}, texels) == 0);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      CHECK(texels.at(x, y).x == Approx(0.5 * (x + 0.5) / 16).margin(1e-6));
      CHECK(texels.at(x, y).y == Approx(0.5 * (y + 0.5) / 16).margin(1e-6));
    }
  TriangleMesh twice = uv_mesh({{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 0}, {1, 1}}});
  twice.colours = {{1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}};
  TexelArray shared{4, 4, std::vector<Vec4f>(16, Vec4f(1))};
  CHECK(bake_vertex_colours(twice, all_triangles(twice), {}, shared) == 1);
  CHECK(shared.at(3, 0).x == Approx(0.5));
}

TEST_CASE("an object with several materials asks the right field") {
  TriangleMesh mesh = square();
  mesh.materials = {2, 0};
  std::vector<std::unique_ptr<AlbedoField>> fields(3);
  fields[2] = std::make_unique<ConstantAlbedo>(Rgb(0.1, 0.9, 0.3));
  const ObjectAlbedo field(mesh, std::move(fields));
  CHECK(field.at(mesh.surface_point(0, {0.2, 0.2})) == Rgb(0.1, 0.9, 0.3));
  CHECK(field.at(mesh.surface_point(1, {0.2, 0.2})) == Rgb(0));
  KernelFootprint footprint;
  footprint.triangle = 0;
  CHECK(field.filtered(footprint) == Rgb(0.1, 0.9, 0.3));
  CHECK(field.max() == Rgb(0.1, 0.9, 0.3));
}
