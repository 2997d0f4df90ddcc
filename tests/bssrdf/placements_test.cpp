#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include "bssrdf/aggregation_kernel.h"
#include "bssrdf/body.h"
#include "geometry/shapes.h"

using namespace alabaster;

namespace {

constexpr std::array<KernelTap, 4> taps{{ek17_kernel[0], ek17_kernel[1], ek17_kernel[2], {0.4, 0.3, 0, 1}}};

std::array<KernelFootprint, 4> place(const KernelPlacement& placement, const SurfacePoint& a,
                                     const SurfacePoint& b) {
  std::array<KernelFootprint, 4> result;
  placement.place(a, b, glm::distance(a.position, b.position), taps, result);
  return result;
}

Mat2 covariance(const KernelFootprint& f) {
  return f.sigma * f.sigma * f.uv_from_surface * glm::transpose(f.uv_from_surface);
}

double largest_entry(const Mat2& m) {
  return std::max({std::abs(m[0][0]), std::abs(m[0][1]), std::abs(m[1][0]), std::abs(m[1][1])});
}

/// A plane somewhere in space with UVs stretched and sheared.
TriangleMesh tilted_plane() {
  TriangleMesh mesh = make_plane(4, 6);
  const Mat4 turn = glm::rotate(Mat4(1), 0.8, glm::normalize(Vec3(1, -2, 0.5)));
  for (Vec3& p : mesh.positions) p = Vec3(turn * Vec4(p, 1)) + Vec3(3, -2, 5);
  for (Vec3f& n : mesh.normals) n = Vec3f(turn * Vec4(n, 0));
  for (Vec2f& uv : mesh.uv_sets[0]) uv = Vec2f(2.5F * uv.x + 0.4F * uv.y, 0.7F * uv.y - 1);
  return mesh;
}

}  // namespace

TEST_CASE("on a plane interpolation, queries and the affine map agree", "[bssrdf]") {
  const TriangleMesh mesh = tilted_plane();
  const Body fast(mesh), slow(mesh, -1);
  const Frame frame(mesh.geometric_normal(0));
  const PlanarPlacement planar(
      Mat2(fast.atlas.uv_from_surface(0, frame.tangent), fast.atlas.uv_from_surface(0, frame.bitangent)));
  const auto points = points_on(mesh, 60, 1);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    CHECK(fast.placement.interpolates(points[k], points[k + 1]));
    CHECK_FALSE(slow.placement.interpolates(points[k], points[k + 1]));
    const auto a = place(fast.placement, points[k], points[k + 1]);
    const auto b = place(slow.placement, points[k], points[k + 1]);
    const auto c = place(planar, points[k], points[k + 1]);
    for (std::size_t t = 0; t < taps.size(); ++t) {
      // The sideways tap may leave the square, where the closest point stays behind.
      const Vec3 wanted = points[k].position + taps[t].along * (points[k + 1].position - points[k].position);
      CHECK(glm::distance(a[t].uv, c[t].uv) < 1e-5);
      CHECK(largest_entry(covariance(a[t]) - covariance(c[t])) < 1e-5);
      if (taps[t].across != 0) continue;
      CHECK(glm::distance(a[t].uv, b[t].uv) < 1e-5);
      CHECK(largest_entry(covariance(a[t]) - covariance(b[t])) < 1e-5);
      CHECK(glm::distance(mesh.position(b[t].triangle, b[t].barycentric), wanted) < 1e-5);
    }
  }
}

TEST_CASE("a kernel tap off the line lands sideways in the surface", "[bssrdf]") {
  const TriangleMesh mesh = tilted_plane();
  const Body slow(mesh, -1);
  const SurfacePoint a = mesh.surface_point(20, {0.3, 0.3}), b = mesh.surface_point(40, {0.2, 0.5});
  const auto placed = place(slow.placement, a, b);
  const Vec3 chord = b.position - a.position;
  const Vec3 offset = mesh.position(placed[3].triangle, placed[3].barycentric) - (a.position + 0.4 * chord);
  CHECK(glm::dot(offset, chord) == Approx(0).margin(1e-5));
  CHECK(glm::length(offset) == Approx(0.3 * glm::length(chord)).epsilon(1e-4));
}

TEST_CASE("most pairs need no query, and the cubic lands where queries do", "[bssrdf]") {
  struct Case {
    const char* name;
    TriangleMesh mesh;
    double most;  // fraction of pairs that may need queries: seams, poles
  };
  const Case cases[] = {{"sphere", make_sphere(1, 64), 0.04},
                        {"blob of six charts", make_blob(1, 0.25, 64), 0.09},
                        {"torus", make_torus(1, 0.4, 96), 0.04}};
  for (const Case& c : cases) {
    const Body body(c.mesh), slow(c.mesh, -1);
    const auto points = points_on(body.mesh, 2000, 9);
    Rng rng(2);
    int queries = 0, close = 0;
    for (const SurfacePoint& exit : points) {
      const Vec3 direction = glm::normalize(Vec3(rng.uniform(), rng.uniform(), rng.uniform()) - 0.5);
      const auto closest = body.rays.closest_point(0, exit.position + 0.1 * direction);
      const SurfacePoint entry = body.mesh.surface_point(closest->triangle, closest->barycentric);
      if (!body.placement.interpolates(entry, exit)) {
        ++queries;
        continue;
      }
      const double d = glm::distance(entry.position, exit.position);
      const auto fast = place(body.placement, entry, exit), exact = place(slow.placement, entry, exit);
      double worst = 0;  // in metres along the surface, over d
      for (std::size_t t = 0; t < 3; ++t)
        worst = std::max(
            worst, glm::length(glm::inverse(exact[t].uv_from_surface) * (fast[t].uv - exact[t].uv)) / d);
      close += worst < 0.03;
    }
    CAPTURE(c.name, queries, close);
    CHECK(queries < c.most * 2000);
    CHECK(queries > 0);
    CHECK(close > 0.97 * (2000 - queries));
  }
}

TEST_CASE("placed points lie near the chord and on the surface", "[bssrdf]") {
  const Body body(make_blob(1, 0.25, 64), -1);
  const auto points = points_on(body.mesh, 300, 4);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const SurfacePoint &a = points[k], &b = points[k + 1];
    const double d = glm::distance(a.position, b.position);
    const auto placed = place(body.placement, a, b);
    for (std::size_t t = 0; t < 3; ++t) {
      const Vec3 wanted = a.position + taps[t].along * (b.position - a.position);
      const Vec3 reached = body.mesh.position(placed[t].triangle, placed[t].barycentric);
      const double limit = std::min(taps[t].along, 1 - taps[t].along) * d;
      CHECK(glm::distance(wanted, reached) <= limit + 1e-4);
      CHECK(placed[t].sigma == Approx(taps[t].sigma * d));
      CHECK(glm::distance(placed[t].uv, body.mesh.uv(placed[t].triangle, placed[t].barycentric)) < 1e-6);
    }
  }
}

TEST_CASE("on a bent chart the taps near an end lie in its tangent plane, within their width of the query's",
          "[bssrdf]") {
  TriangleMesh wrinkled = make_plane(1, 128);
  for (Vec3& p : wrinkled.positions) p.z = 0.04 * std::sin(40 * p.x) * std::sin(40 * p.y);
  compute_smooth_normals(wrinkled);
  const Body fast(wrinkled), slow(wrinkled, -1);
  const auto points = points_on(fast.mesh, 20000, 5);
  int pairs = 0, close = 0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const SurfacePoint &a = points[k], &b = points[k + 1];
    const double d = glm::distance(a.position, b.position);
    const bool bent =
        fast.atlas.chart(a.triangle) == fast.atlas.chart(b.triangle) && !fast.placement.interpolates(a, b);
    if (!bent || d > 0.2) continue;
    ++pairs;
    const auto quick = place(fast.placement, a, b), exact = place(slow.placement, a, b);
    bool all = true;
    for (std::size_t t = 1; t < 3; ++t)
      all &= glm::length(glm::inverse(exact[t].uv_from_surface) * (quick[t].uv - exact[t].uv)) <
             1.0 * exact[t].sigma;
    close += all;
  }
  CAPTURE(pairs, close);
  CHECK(pairs > 50);
  CHECK(close > 0.75 * pairs);  // 84 % of these, on slopes of up to 1.6
}

TEST_CASE("across a fold's gap the kernel does not follow the unrolled texture", "[bssrdf]") {
  const Body body(make_folded_sheet(4, 0.5, 0.1, 32));
  // Two points that face each other across the gap: next to each other in space, far apart on the sheet.
  const SurfacePoint top = [&] {
    const auto c = body.rays.closest_point(0, {1, 0.05, 0});
    return body.mesh.surface_point(c->triangle, c->barycentric);
  }();
  const SurfacePoint bottom = [&] {
    const auto c = body.rays.closest_point(0, {1, -0.05, 0.01});
    return body.mesh.surface_point(c->triangle, c->barycentric);
  }();
  REQUIRE(glm::dot(top.geometric_normal, bottom.geometric_normal) < -0.9);
  CHECK_FALSE(body.placement.interpolates(top, bottom));
  for (const KernelFootprint& f : place(body.placement, top, bottom)) {
    const Vec3 reached = body.mesh.position(f.triangle, f.barycentric);
    CHECK(std::min(glm::distance(reached, top.position), glm::distance(reached, bottom.position)) < 0.1);
  }
}

TEST_CASE("a mesh without UVs is placed by queries", "[bssrdf]") {
  TriangleMesh mesh = make_sphere(1, 24);
  mesh.uv_sets.clear();
  const Body body(mesh);
  const auto points = points_on(mesh, 10, 4);
  CHECK_FALSE(body.placement.interpolates(points[0], points[1]));
  for (const KernelFootprint& f : place(body.placement, points[0], points[1])) CHECK(f.uv == Vec2(0));
}
