#include "texture/surface_pyramid.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/rng.h"
#include "geometry/shapes.h"
#include "support/uv_meshes.h"
#include "texture/material_map.h"
#include "texture/surface_albedo.h"

using namespace alabaster;

namespace {

/// An albedo that depends on the place in space alone.
class SolidAlbedo final : public AlbedoField {
 public:
  explicit SolidAlbedo(std::function<double(const Vec3&)> value) : value_(std::move(value)) {}
  Rgb at(const SurfacePoint& point) const override { return Rgb(value_(point.position)); }
  Rgb filtered(const KernelFootprint& footprint) const override { return Rgb(value_(footprint.position)); }
  Rgb max() const override { return Rgb(1); }

 private:
  std::function<double(const Vec3&)> value_;
};

SurfacePyramid pyramid_of(const TriangleMesh& mesh, const AlbedoField& field, double finest) {
  return SurfacePyramid(mesh, all_triangles(mesh), field, finest);
}

Vec3 random_point(const TriangleMesh& mesh, Rng& rng) {
  const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
  const double u = std::sqrt(rng.uniform()), v = rng.uniform();
  return mesh.position(t, {u * (1 - v), u * v});
}

}  // namespace

TEST_CASE("in space one albedo everywhere comes out exactly") {
  const TriangleMesh mesh = make_blob(1, 0.25, 24);
  const Rgb albedo(0.1, 0.7, 0.999);
  const ConstantAlbedo field(albedo);
  const SurfacePyramid pyramid = pyramid_of(mesh, field, 0.02);
  Rng rng(1);
  for (int n = 0; n < 2000; ++n) {
    const double sigma = 0.01 * std::exp(6 * rng.uniform());
    const Vec3 p =
        random_point(mesh, rng) + sigma * (Vec3(rng.uniform(), rng.uniform(), rng.uniform()) - 0.5);
    const Rgb value = pyramid.filtered(p, sigma);
    for (int c = 0; c < 3; ++c) REQUIRE(static_cast<float>(value[c]) == static_cast<float>(albedo[c]));
  }
}

TEST_CASE("on a plane the average in space is the Gaussian's on the surface, at any height") {
  // A cosine keeps its shape and is lowered by exp(-k^2 sigma^2 / 2).
  const TriangleMesh mesh = make_plane(8, 4);
  constexpr double finest = 0.05;
  for (const double wave : {3.0, 8.0, 20.0}) {
    const SolidAlbedo field(
        [&](const Vec3& p) { return 0.5 + 0.4 * std::cos(wave * (0.8 * p.x + 0.6 * p.y)); });
    const SurfacePyramid pyramid = pyramid_of(mesh, field, finest);
    Rng rng(2);
    double worst = 0, squared = 0;
    constexpr int count = 2000;
    for (int n = 0; n < count; ++n) {
      const double sigma = finest * std::exp(2.0 * rng.uniform());
      const Vec3 p(2 * rng.uniform() - 1, 2 * rng.uniform() - 1, sigma * (2 * rng.uniform() - 1));
      const double exact =
          0.5 + 0.4 * std::exp(-0.5 * wave * wave * sigma * sigma) * std::cos(wave * (0.8 * p.x + 0.6 * p.y));
      const double error = std::abs(pyramid.filtered(p, sigma).r - exact) / 0.8;
      worst = std::max(worst, error), squared += error * error / count;
    }
    CAPTURE(wave, worst, std::sqrt(squared));
    CHECK(std::sqrt(squared) < 0.012);
    CHECK(worst < 0.035);
  }
}

TEST_CASE("on a sphere the average in space is von Mises and Fisher's") {
  // Weights exp(-|x - p|^2 / 2 sigma^2) on radius 1 are exp(k cos), k = |p| / sigma^2: the mean of cos is
  // coth k - 1 / k.
  const TriangleMesh mesh = make_blob(1, 0, 96);
  const Vec3 axis = glm::normalize(Vec3(1, 2, -0.5));
  const SolidAlbedo field([&](const Vec3& p) { return 0.5 + 0.4 * glm::dot(p, axis); });
  const SurfacePyramid pyramid = pyramid_of(mesh, field, 0.05);
  for (const double sigma : {0.05, 0.07, 0.1, 0.2, 0.33, 0.5, 0.8, 1.2})
    for (const double radius : {1.0, 1 - 0.4 * std::min(sigma, 1.0)})
      for (const double angle : {0.0, 0.9, 2.0, 3.0}) {
        const Vec3 other = glm::normalize(glm::cross(axis, Vec3(0, 0, 1)));
        const Vec3 p = radius * (std::cos(angle) * axis + std::sin(angle) * other);
        const double k = radius / (sigma * sigma);
        const double mean = 1 / std::tanh(k) - 1 / k;
        CAPTURE(sigma, radius, angle);
        CHECK(pyramid.filtered(p, sigma).r == Approx(0.5 + 0.4 * mean * std::cos(angle)).margin(0.016));
      }
}

TEST_CASE("averages in space stay within the values on the surface and meet from level to level") {
  const TriangleMesh mesh = make_blob(1, 0.25, 48);
  const SolidAlbedo field(
      [](const Vec3& p) { return std::sin(9 * p.x) * std::sin(9 * p.y) > 0 ? 0.9 : 0.2; });
  const SurfacePyramid pyramid = pyramid_of(mesh, field, 0.03);
  Rng rng(3);
  for (int n = 0; n < 300; ++n) {
    const Vec3 p = random_point(mesh, rng);
    double last = pyramid.filtered(p, 0.03).r;
    for (double sigma = 0.03; sigma < 3; sigma *= 1.01) {
      const double value = pyramid.filtered(p, sigma).r;
      REQUIRE(value >= 0.2 - 1e-6);
      REQUIRE(value <= 0.9 + 1e-6);
      REQUIRE(std::abs(value - last) < 0.01);
      last = value;
    }
  }
  const double everywhere = pyramid.filtered(Vec3(0), 1e6).r;
  CHECK(everywhere == Approx(pyramid.filtered(Vec3(0.1, 0, 0), 1e9).r).margin(0.02));
}

TEST_CASE("a place far from the surface is answered by what is nearest, and nothing is asked in vain") {
  const TriangleMesh mesh = make_plane(1, 2);
  const SolidAlbedo field([](const Vec3& p) { return p.x > 0 ? 0.8 : 0.3; });
  const SurfacePyramid pyramid = pyramid_of(mesh, field, 0.01);
  CHECK(pyramid.filtered(Vec3(0.4, 0, 0.1), 0.01).r > 0.7);
  CHECK(pyramid.filtered(Vec3(-0.4, 0, -0.1), 0.01).r < 0.4);
  for (const Vec3& p : {Vec3(5, 0, 0), Vec3(0, 0, 1e6), Vec3(-1e9, 3, 2)})
    for (const double sigma : {0.0, 0.01, 100.0}) {
      const double value = pyramid.filtered(p, sigma).r;
      CHECK(value >= 0.3 - 1e-6);
      CHECK(value <= 0.8 + 1e-6);
    }
}

TEST_CASE("scale and place of the object do not matter") {
  TriangleMesh mesh = make_torus(1, 0.4, 48), moved = mesh;
  constexpr double scale = 1e-4;
  const Vec3 shift(300, -20, 7);
  for (Vec3& p : moved.positions) p = scale * p + shift;
  const auto value = [](const Vec3& p) { return 0.5 + 0.4 * std::sin(5 * p.x + 3 * p.z); };
  const SolidAlbedo field(value), moved_field([&](const Vec3&p) { return value((p - shift) / scale); });
  const SurfacePyramid a = pyramid_of(mesh, field, 0.05), b = pyramid_of(moved, moved_field, scale * 0.05);
  Rng rng(4);
  for (int n = 0; n < 200; ++n) {
    const Vec3 p = random_point(mesh, rng);
    const double sigma = 0.05 * std::exp(3 * rng.uniform());
    CHECK(b.filtered(scale * p + shift, scale * sigma).r == Approx(a.filtered(p, sigma).r).margin(1e-4));
  }
}

TEST_CASE(
    "a pyramid over space leaves room for the texture's own within 1.5 times a float texture's memory") {
  for (const TriangleMesh& mesh : {make_blob(1, 0.25, 64), make_slab(2, 0.1, 8),
                                   make_folded_sheet(2, 0.2, 0.1, 32), make_torus(1, 0.3, 96)}) {
    const SolidAlbedo field([](const Vec3& p) { return p.x > 0 ? 0.8 : 0.3; });
    constexpr std::size_t texels = 512 * 512;
    const double finest = finest_pyramid_sigma(mesh, all_triangles(mesh), 1e-4, texels);
    const SurfacePyramid pyramid = pyramid_of(mesh, field, finest);
    CAPTURE(finest, pyramid.memory_bytes());
    CHECK(static_cast<double>(pyramid.memory_bytes()) < 0.76 * texels * sizeof(Vec4f));
    CHECK(pyramid.finest_sigma() == Approx(finest));
  }
}

TEST_CASE("narrow Gaussians are the field's, wide ones the pyramid's, and the two meet") {
  const TriangleMesh mesh = make_blob(1, 0.25, 24);
  const auto field = [] {
    return std::make_unique<SolidAlbedo>([](const Vec3& p) { return p.x > 0 ? 0.8 : 0.3; });
  };
  const auto pyramid = std::make_shared<const SurfacePyramid>(pyramid_of(mesh, *field(), 0.1));
  const SurfaceAlbedo both(mesh, field(), {pyramid});
  CHECK(both.by_position_from() == Approx(pyramid->finest_sigma()));
  KernelFootprint f;
  f.position = mesh.position(3, {0.2, 0.2});
  f.sigma = 0.0707;
  CHECK(both.filtered(f) == field()->filtered(f));
  f.sigma = 0.1001;
  CHECK(both.filtered(f) == pyramid->filtered(f.position, 0.1001));
  double last = both.filtered(f).r;
  for (; f.sigma > 0.06; f.sigma *= 0.999) {
    CHECK(std::abs(both.filtered(f).r - last) < 0.005);
    last = both.filtered(f).r;
  }
  const SurfaceAlbedo alone(mesh, field(), {nullptr});
  CHECK(std::isinf(alone.by_position_from()));
  f.sigma = 5;
  CHECK(alone.filtered(f) == field()->filtered(f));
}

TEST_CASE("a plane with one affine map of UV needs no pyramid over space") {
  const TriangleMesh plane = make_plane(2, 8), sphere = make_sphere(1, 16), slab = make_slab(1, 0.2, 4);
  CHECK(is_affine(plane, UvAtlas(plane), all_triangles(plane)));
  CHECK_FALSE(is_affine(sphere, UvAtlas(sphere), all_triangles(sphere)));
  CHECK_FALSE(is_affine(slab, UvAtlas(slab), all_triangles(slab)));
  TriangleMesh bent = plane;
  bent.uv_sets[0][5].x += 0.01F;
  CHECK_FALSE(is_affine(bent, UvAtlas(bent), all_triangles(bent)));
}

TEST_CASE("needles take points by their length, and average as the same surface cut regularly") {
  // Triangles of length 1 that fan out over a width of `width`, each cut into `cuts` along its length.
  const auto fan = [](int needles, double width, int cuts) {
    std::vector<UvTriangle> triangles;
    for (int n = 0; n < needles; ++n) {
      const double low = width * n / needles, high = width * (n + 1) / needles;
      const auto at = [&](double y, int k) { return Vec2(k, y * k) / static_cast<double>(cuts); };
      triangles.push_back({Vec2(0), at(low, 1), at(high, 1)});
      for (int k = 1; k < cuts; ++k) {
        triangles.push_back({at(low, k), at(low, k + 1), at(high, k + 1)});
        triangles.push_back({at(low, k), at(high, k + 1), at(high, k)});
      }
    }
    return uv_mesh(triangles);
  };
  std::atomic<std::size_t> points = 0;
  const SolidAlbedo field([&](const Vec3& p) {
    ++points;
    return 0.5 + 0.4 * std::cos(40 * p.x);
  });
  constexpr double finest = 0.01;
  // One needle of aspect 10^5, and a triangle of aspect 5 made of forty of aspect 200.
  for (const auto& [needles, width] : {std::pair{1, 1e-5}, std::pair{40, 0.2}}) {
    points = 0;
    const SurfacePyramid pyramid = pyramid_of(fan(needles, width, 1), field, finest);
    // A fifth of the spacing, finest sigma / sqrt(7 / 6), apart; the rest tells the range of the values.
    CHECK(static_cast<double>(points.load()) <
          5.4 / finest * needles * (1 + 5.4 * width / needles / finest) + 64 * needles);
    const SurfacePyramid regular = pyramid_of(fan(needles, width, 200), field, finest);
    for (const double sigma : {0.01, 0.03, 0.1, 1.0})
      for (double x = 0.1; x <= 1; x += 0.0317) {
        CAPTURE(needles, sigma, x);
        const Vec3 p(x, 0.4 * width * x, 0);
        CHECK(pyramid.filtered(p, sigma).r == Approx(regular.filtered(p, sigma).r).margin(0.005));
      }
  }
}
