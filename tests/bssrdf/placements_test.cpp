#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include "bssrdf/aggregation_kernel.h"
#include "bssrdf/body.h"
#include "core/error.h"
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
  const Body body(mesh);
  const Frame frame(mesh.geometric_normal(0));
  const PlanarPlacement planar(
      Mat2(body.atlas.uv_from_surface(0, frame.tangent), body.atlas.uv_from_surface(0, frame.bitangent)));
  const auto points = points_on(mesh, 60, 1);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    CHECK(body.placement.trust(points[k], points[k + 1]) == 1);
    const auto a = place(body.placement, points[k], points[k + 1]);
    const auto b = place(body.projected, points[k], points[k + 1]);
    const auto c = place(planar, points[k], points[k + 1]);
    for (std::size_t t = 0; t < taps.size(); ++t) {
      // The sideways tap may leave the square, where the closest point stays behind.
      const Vec3 wanted = points[k].position + taps[t].along * (points[k + 1].position - points[k].position);
      CHECK(glm::distance(a[t].uv, c[t].uv) < 1e-5);
      CHECK(glm::distance(a[t].position, wanted) < 1e-12 + taps[t].across * 6);
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
  const Body body(mesh);
  const SurfacePoint a = mesh.surface_point(20, {0.3, 0.3}), b = mesh.surface_point(40, {0.2, 0.5});
  const auto placed = place(body.projected, a, b);
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
    const Body body(c.mesh);
    const auto points = points_on(body.mesh, 2000, 9);
    Rng rng(2);
    int queries = 0, close = 0;
    for (const SurfacePoint& exit : points) {
      const Vec3 direction = glm::normalize(Vec3(rng.uniform(), rng.uniform(), rng.uniform()) - 0.5);
      const auto closest = body.rays.closest_point(0, exit.position + 0.1 * direction);
      const SurfacePoint entry = body.mesh.surface_point(closest->triangle, closest->barycentric);
      if (body.placement.trust(entry, exit) < 1) {
        ++queries;
        continue;
      }
      const double d = glm::distance(entry.position, exit.position);
      const auto fast = place(body.placement, entry, exit), exact = place(body.projected, entry, exit);
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
  const Body body(make_blob(1, 0.25, 64));
  const auto points = points_on(body.mesh, 300, 4);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const SurfacePoint &a = points[k], &b = points[k + 1];
    const double d = glm::distance(a.position, b.position);
    const auto placed = place(body.projected, a, b);
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
  const Body body(wrinkled);
  const auto points = points_on(body.mesh, 20000, 5);
  int pairs = 0, close = 0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const SurfacePoint &a = points[k], &b = points[k + 1];
    const double d = glm::distance(a.position, b.position);
    const bool bent =
        body.atlas.chart(a.triangle) == body.atlas.chart(b.triangle) && body.placement.trust(a, b) == 0;
    if (!bent || d > 0.2) continue;
    ++pairs;
    const auto quick = place(body.placement, a, b), exact = place(body.projected, a, b);
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
  CHECK(body.placement.trust(top, bottom) == 0);
  const auto placed = place(body.placement, top, bottom);
  for (const KernelFootprint& f : std::span(placed.data(), 3)) {
    CHECK(std::min(glm::distance(f.position, top.position), glm::distance(f.position, bottom.position)) <
          0.1);
    CHECK((f.triangle == top.triangle || f.triangle == bottom.triangle));
  }
}

TEST_CASE("a mesh without UVs is placed in the planes of the ends' triangles", "[bssrdf]") {
  TriangleMesh mesh = make_sphere(1, 24);
  mesh.uv_sets.clear();
  const Body body(mesh);
  const auto points = points_on(mesh, 10, 4);
  CHECK(body.placement.trust(points[0], points[1]) == 0);
  for (const KernelFootprint& f : place(body.placement, points[0], points[1])) CHECK(f.uv == Vec2(0));
  const auto placed = place(body.placement, points[0], points[1]);
  const Vec3 offset = mesh.position(placed[2].triangle, placed[2].barycentric) - placed[2].position;
  CHECK(glm::length(glm::cross(offset, points[0].geometric_normal)) < 1e-9);  // straight below
}

TEST_CASE("kernels that widen from their end need no query, wherever the pair lies", "[bssrdf]") {
  // Without a ray scene a query would crash.
  const TriangleMesh mesh = make_blob(1, 0.4, 24);
  const UvAtlas atlas(mesh);
  const ChordPlacement placement({&mesh, &atlas, nullptr, 0});
  const auto points = points_on(mesh, 500, 6);
  for (std::size_t k = 0; k + 1 < points.size(); ++k)
    for (const std::span<const KernelTap> kernel :
         {std::span<const KernelTap>(ek17_kernel), std::span<const KernelTap>(symmetric_ek17_kernel)}) {
      std::array<KernelFootprint, 6> footprints;
      const double d = glm::distance(points[k].position, points[k + 1].position);
      placement.place(points[k], points[k + 1], d, kernel, std::span(footprints.data(), kernel.size()));
      for (std::size_t t = 0; t < kernel.size(); ++t) {
        const Vec3 wanted =
            points[k].position + kernel[t].along * (points[k + 1].position - points[k].position);
        CHECK(glm::distance(footprints[t].position, wanted) < 1e-12);
        CHECK(footprints[t].sigma == Approx(kernel[t].sigma * d));
        CHECK(std::isfinite(footprints[t].uv.x + footprints[t].uv.y));
      }
    }
}

TEST_CASE("wide taps are a place in space", "[bssrdf]") {
  const TriangleMesh mesh = make_blob(1, 0.25, 24);
  const Body body(mesh);
  PlacementBody parts = body.parts();
  parts.by_position_from = 0.1;
  const ChordPlacement placement(parts);
  const auto points = points_on(mesh, 100, 6);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const auto with = place(placement, points[k], points[k + 1]),
               without = place(body.placement, points[k], points[k + 1]);
    for (std::size_t t = 0; t < 3; ++t) {
      CHECK(with[t].position == without[t].position);
      CHECK(with[t].triangle == without[t].triangle);
      if (with[t].sigma < 0.1)
        CHECK(with[t].uv == without[t].uv);
      else
        CHECK(with[t].uv == Vec2(0));  // not looked for
    }
  }
}

TEST_CASE("placements by name: on a plane all are eq. 1, on a sphere arcs and paths keep to it", "[bssrdf]") {
  const Body plane(tilted_plane()), sphere(make_blob(1, 0, 48));
  for (const char* name : {"chord", "arc", "projected-chord", "straightest"}) {
    CAPTURE(name);
    const auto on_plane = make_placement(name, plane.parts()),
               on_sphere = make_placement(name, sphere.parts());
    const auto points = points_on(plane.mesh, 20, 1);
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      std::array<KernelFootprint, 3> a, b;
      const double d = glm::distance(points[k].position, points[k + 1].position);
      on_plane->place(points[k], points[k + 1], d, ek17_kernel, a);
      plane.placement.place(points[k], points[k + 1], d, ek17_kernel, b);
      for (std::size_t t = 0; t < 3; ++t) {
        CHECK(glm::distance(a[t].uv, b[t].uv) < 1e-5);
        CHECK(glm::distance(a[t].position, b[t].position) < 1e-5);
        CHECK(a[t].sigma == Approx(b[t].sigma).epsilon(1e-5));
      }
    }
    const std::string_view way = name;
    for (const SurfacePoint& exit : points_on(sphere.mesh, 20, 3)) {
      const auto closest = sphere.rays.closest_point(0, exit.position + Vec3(0.3, -0.3, 0.2));
      const SurfacePoint entry = sphere.mesh.surface_point(closest->triangle, closest->barycentric);
      const double d = glm::distance(entry.position, exit.position);
      if (d < 0.05) continue;
      std::array<KernelFootprint, 3> placed;
      on_sphere->place(entry, exit, d, ek17_kernel, placed);
      const double length = way == "arc" || way == "straightest" ? 2 * std::asin(0.5 * d) : d;
      for (std::size_t t = 0; t < 3; ++t) {
        CHECK(placed[t].sigma == Approx(ek17_kernel[t].sigma * length).epsilon(0.005));
        if (way != "chord") CHECK(glm::length(placed[t].position) == Approx(1).margin(0.006));
      }
    }
  }
  CHECK_THROWS_AS(make_placement("string", plane.parts()), InputError);
}
