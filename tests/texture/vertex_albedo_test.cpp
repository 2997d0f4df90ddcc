#include "texture/vertex_albedo.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "core/rng.h"
#include "geometry/shapes.h"
#include "support/uv_meshes.h"

using namespace alabaster;

namespace {

std::vector<Rgb> albedo_by(const TriangleMesh& mesh, const std::function<double(const Vec3&)>& value) {
  std::vector<Rgb> albedo(mesh.normals.size());
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::size_t c = 0; c < 3; ++c)
      albedo[mesh.attributes[t][c]] = Rgb(value(mesh.positions[mesh.corners[t][c]]));
  return albedo;
}

KernelFootprint footprint_at(uint32_t triangle, Vec2 barycentric, double sigma) {
  KernelFootprint footprint;
  footprint.triangle = triangle;
  footprint.barycentric = barycentric;
  footprint.sigma = sigma;
  return footprint;
}

}  // namespace

TEST_CASE("vertex albedo: linear inside a triangle, constant stays constant at every width") {
  const TriangleMesh mesh = make_sphere(1, 48);
  const VertexAlbedo field(mesh, all_triangles(mesh), albedo_by(mesh, [](const Vec3&) { return 0.7; }));
  Rng rng(1);
  for (int n = 0; n < 500; ++n) {
    const auto triangle = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
    const Vec2 b(0.5 * rng.uniform(), 0.5 * rng.uniform());
    CHECK(field.at(mesh.surface_point(triangle, b)).r == Approx(0.7));
    CHECK(field.filtered(footprint_at(triangle, b, 0.01 * std::exp(7 * rng.uniform()))).r ==
          Approx(0.7).epsilon(1e-6));
  }
  CHECK(field.max() == Rgb(0.7));
  CHECK(field.level_count() > 3);
}

TEST_CASE("vertex albedo: an edge between two tones on a plane blurs as a Gaussian does") {
  const TriangleMesh mesh = make_plane(2, 80);
  const VertexAlbedo field(mesh, all_triangles(mesh), albedo_by(mesh, [](const Vec3& p) {
                             return p.x < -1e-9 ? 0.2 : p.x > 1e-9 ? 0.8 : 0.5;
                           }));
  for (const double sigma : {0.04, 0.07, 0.1, 0.15}) {
    double largest = 0;
    for (uint32_t t = 0; t < mesh.triangle_count(); t += 7) {
      const Vec3 p = mesh.position(t, {0.3, 0.3});
      if (std::max(std::abs(p.x), std::abs(p.y)) > 0.5) continue;
      const double exact = 0.5 + 0.3 * std::erf(p.x / (sigma * std::sqrt(2.0)));
      largest =
          std::max(largest, std::abs(field.filtered(footprint_at(t, {0.3, 0.3}, sigma)).r - exact) / 0.6);
    }
    INFO("sigma " << sigma);
    CHECK(largest < 0.06);
  }
}

TEST_CASE("vertex albedo: the two sides of a thin slab do not mix") {
  const TriangleMesh mesh = make_slab(4, 0.02, 40);
  const VertexAlbedo field(mesh, all_triangles(mesh),
                           albedo_by(mesh, [](const Vec3& p) { return p.y > 0 ? 0.9 : 0.1; }));
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 p = mesh.position(t, Vec2(1.0 / 3));
    if (std::max(std::abs(p.x), std::abs(p.z)) > 0.5) continue;
    INFO("at " << p.x << ", " << p.y << ", " << p.z);
    CHECK(field.filtered(footprint_at(t, Vec2(1.0 / 3), 0.3)).r == Approx(p.y > 0 ? 0.9 : 0.1).margin(0.01));
  }
}
