// What the rest of an atlas holds, and where its seams run, must not show in an image.

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "integrators/scene_builder.h"
#include "support/uv_meshes.h"
#include "texture/coverage.h"

using namespace alabaster;
using namespace alabaster::test;

namespace {

constexpr int side = 256;

/// Every triangle a chart of its own, in a grid of cells.
TriangleMesh shattered(TriangleMesh mesh) {
  const auto cells = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(mesh.triangle_count()))));
  std::vector<Vec2f> uvs;
  std::vector<Vec3f> normals;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 place = std::array{Vec2(0.2, 0.2), Vec2(0.8, 0.2), Vec2(0.2, 0.8)}[k];
      normals.push_back(mesh.normals[mesh.attributes[t][k]]);
      uvs.emplace_back((Vec2(t % cells, t / cells) + place) / static_cast<double>(cells));
      mesh.attributes[t][k] = static_cast<uint32_t>(uvs.size() - 1);
    }
  mesh.uv_sets[0] = uvs;
  mesh.normals = normals;
  return mesh;
}

/// One colour wherever the mesh shows it, magenta elsewhere.
std::shared_ptr<const Texture> painted(const TriangleMesh& mesh, const Vec3f& colour) {
  auto texels = std::make_shared<TexelArray>();
  *texels = {side, side, std::vector<Vec4f>(std::size_t{side} * side, Vec4f(1, 0, 1, 1))};
  for_each_covered_texel(mesh, all_triangles(mesh), {}, side, side,
                         [&](std::size_t i, uint32_t, Vec2) { texels->texels[i] = Vec4f(colour, 1); });
  return std::make_shared<Texture>(texels, TextureMapping{});
}

}  // namespace

TEST_CASE("one colour in a shattered atlas renders as one colour, to 1e-5") {
  const TriangleMesh mesh = shattered(make_blob(0.01, 0.25, 12));
  const Vec3f colour(0.3F, 0.6F, 0.95F);
  const auto scene_of = [&](const std::shared_ptr<const Texture>& texture) {
    Scene scene;
    Material material = medium_material(texture ? Rgb(1) : Rgb(colour.x, colour.y, colour.z), Rgb(0.001));
    material.albedo.texture = texture;
    add(scene, mesh, material);
    scene.environment = make_constant_environment(Rgb(1));
    prepare_scene(scene);
    return scene;
  };
  const Scene plain = scene_of(nullptr), textured = scene_of(painted(mesh, colour));
  for (const Basis basis : {Basis::half_space, Basis::shape}) {
    SurfaceOptions options;
    options.width = options.height = 12;
    options.basis = basis;
    options.camera = parallel_camera(Vec3(0), Vec3(1, 0.6, 0.8), 0.1, 0.025);
    const SurfaceIntegrator expected(plain, options), found(textured, options);
    Sampler sampler(SamplerKind::independent, 3);
    int lit = 0;
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 12; ++x)
        for (uint32_t k = 0; k < 8; ++k) {
          sampler.start(x, y, k);
          const Rgb a = expected.sample(x, y, sampler).radiance;
          sampler.start(x, y, k);
          const Rgb b = found.sample(x, y, sampler).radiance;
          for (int c = 0; c < 3; ++c) REQUIRE(std::abs(b[c] - a[c]) <= 1e-5 * a[c]);
          lit += a.is_black() ? 0 : 1;
        }
    CHECK(lit > 400);
  }
}
