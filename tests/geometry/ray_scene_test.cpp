#include "geometry/ray_scene.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/rng.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "geometry/triangle.h"

using namespace alabaster;

namespace {

Vec3 uniform_direction(Rng& rng) {
  const double z = 2 * rng.uniform() - 1, phi = 2 * pi * rng.uniform(), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// A line of the motion-invariant measure through the ball of that radius: uniform direction, uniform foot
/// on the disk perpendicular to it.
Ray line_through_ball(Rng& rng, const Vec3& centre, double radius) {
  const Vec3 d = uniform_direction(rng);
  const Vec3 u =
      glm::normalize(std::abs(d.x) < 0.5 ? glm::cross(d, Vec3(1, 0, 0)) : glm::cross(d, Vec3(0, 1, 0)));
  const double r = radius * std::sqrt(rng.uniform()), phi = 2 * pi * rng.uniform();
  const Vec3 foot = centre + r * (std::cos(phi) * u + std::sin(phi) * glm::cross(d, u));
  Ray ray;
  ray.origin = foot - 2 * radius * d, ray.direction = d, ray.t_max = 4 * radius;
  return ray;
}

Ray ray_along(const Vec3& origin, const Vec3& direction) {
  Ray ray;
  ray.origin = origin, ray.direction = direction;
  return ray;
}

void translate(TriangleMesh& mesh, const Vec3& by, double scale = 1) {
  for (Vec3& p : mesh.positions) p = p * scale + by;
}

RayScene scene_of(const TriangleMesh& mesh) {
  RayScene scene;
  scene.add(mesh);
  scene.commit();
  return scene;
}

}  // namespace

TEST_CASE("rays meet a plane where the plane is", "[ray_scene]") {
  const TriangleMesh plane = make_plane(2, 7);
  const RayScene scene = scene_of(plane);
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 target(1.9 * rng.uniform() - 0.95, 1.9 * rng.uniform() - 0.95, 0);
    const Vec3 origin = target + Vec3(rng.uniform() - 0.5, rng.uniform() - 0.5, 0.2 + rng.uniform());
    const auto hit = scene.nearest(ray_along(origin, 0.5 * (target - origin)));
    REQUIRE(hit);
    CHECK(hit->t == Approx(2).epsilon(1e-5));
    CHECK(glm::length(plane.position(hit->triangle, hit->barycentric) - target) < 1e-5);
    CHECK_FALSE(scene.nearest(ray_along(origin, origin - target)));
    Ray to_target = ray_along(origin, target - origin);
    to_target.t_max = 0.999;
    CHECK_FALSE(scene.occluded(to_target));
    to_target.t_max = 1.001;
    CHECK(scene.occluded(to_target));
    to_target.t_min = 1.0005;
    CHECK_FALSE(scene.occluded(to_target));
  }
}

TEST_CASE("a ray leaves the triangle it starts from, and no other is skipped", "[ray_scene]") {
  const TriangleMesh slab = make_slab(2, 1, 4);
  const RayScene scene = scene_of(slab);
  Rng rng(2);
  for (int i = 0; i < 1000; ++i) {
    const auto triangle = static_cast<uint32_t>(rng.uniform() * static_cast<double>(slab.triangle_count()));
    const SurfacePoint start =
        slab.surface_point(triangle, Vec2(0.2 + 0.2 * rng.uniform(), 0.2 + 0.2 * rng.uniform()));
    Vec3 d = uniform_direction(rng);
    if (glm::dot(d, start.geometric_normal) < 0) d = -d;
    Ray out = ray_along(start.position, d), in = ray_along(start.position, -d);
    out.ignore_object = in.ignore_object = 0, out.ignore_triangle = in.ignore_triangle = triangle;
    CHECK_FALSE(scene.occluded(out));
    CHECK_FALSE(scene.nearest(out));
    CHECK(scene.occluded(in));
    REQUIRE(scene.nearest(in));
    CHECK(scene.nearest(in)->triangle != triangle);
  }
}

TEST_CASE("every line crosses a closed mesh an even number of times, and as often as its area says",
          "[ray_scene]") {
  struct Shape {
    const char* name;
    TriangleMesh mesh;
  };
  std::vector<Shape> shapes;
  shapes.push_back({"sphere", make_sphere(1, 48)});
  shapes.push_back({"torus", make_torus(1, 0.4, 48)});
  shapes.push_back({"folded sheet", make_folded_sheet(2, 0.05, 0.02, 24)});
  shapes.push_back({"slab", make_slab(2, 0.1, 8)});
  shapes.push_back({"sphere far away", make_sphere(1, 48)});
  translate(shapes.back().mesh, Vec3(1e6, -2e6, 3e5));
  shapes.push_back({"sphere of a micrometre", make_sphere(1, 48)});
  translate(shapes.back().mesh, Vec3(0), 1e-6);
  for (const Shape& shape : shapes) {
    INFO(shape.name);
    const RayScene scene = scene_of(shape.mesh);
    const BoundingBox box = bounding_box(shape.mesh);
    const double radius = 0.51 * box.diagonal();
    Rng rng(3);
    std::vector<Hit> hits;
    RunningMoments count;
    int odd = 0;
    for (int i = 0; i < 100000; ++i) {
      scene.all_hits(0, line_through_ball(rng, box.centre(), radius), hits);
      count.add(static_cast<double>(hits.size()));
      if (hits.size() % 2 != 0) ++odd;
    }
    CHECK(odd == 0);
    // Cauchy-Crofton: lines through a ball of surface 4 pi r^2 meet an area A in 2 A / (4 pi r^2) points.
    const double expected = surface_area(shape.mesh) / (2 * pi * radius * radius);
    const double z = (count.mean() - expected) / count.standard_error();
    CHECK(two_sided_normal_p_value(z) > sidak(1e-3, static_cast<double>(shapes.size())));
  }
}

TEST_CASE("a hit on a shared edge or corner is one hit and is never lost", "[ray_scene]") {
  // Lines through vertices, edge midpoints and along grid lines of a plane of 16 x 16 squares, whose
  // coordinates are exact in float.
  const TriangleMesh plane = make_plane(2, 16);
  const RayScene scene = scene_of(plane);
  std::vector<Hit> hits;
  Rng rng(4);
  int checked = 0;
  for (int x = 1; x < 32; ++x)
    for (int y = 1; y < 32; ++y)
      for (int k = 0; k < 8; ++k) {
        const Vec3 target(x / 16.0 - 1, y / 16.0 - 1, 0);
        const Vec3 d = k == 0   ? Vec3(0, 0, 1)
                       : k == 1 ? Vec3(0.25, 0, 1)
                       : k == 2 ? Vec3(0, 0.5, -1)
                                : uniform_direction(rng);
        if (std::abs(d.z) < 0.1) continue;
        scene.all_hits(0, ray_along(target - d, d), hits);
        CHECK(hits.size() == 1);
        CHECK(scene.nearest(ray_along(target - d, d)));
        CHECK(scene.occluded(ray_along(target - d, d)));
        ++checked;
      }
  REQUIRE(checked > 5000);
}

TEST_CASE("a line that grazes a ridge goes in and out there", "[ray_scene]") {
  TriangleMesh roof;  // two triangles of a ridge along x
  roof.positions = {{-1, 0, 1}, {1, 0, 1}, {0, 1, 0}, {0, -1, 0}};
  roof.corners = {{0, 1, 2}, {1, 0, 3}};
  const RayScene scene = scene_of(roof);
  std::vector<Hit> hits;
  scene.all_hits(0, ray_along({0, -2, 1}, {0, 1, 0}), hits);
  CHECK(hits.size() == 2);
  scene.all_hits(0, ray_along({0, 0, 3}, {0, 0, -1}), hits);
  CHECK(hits.size() == 1);
}

TEST_CASE("all_hits sees one object, nearest and occluded see all", "[ray_scene]") {
  const TriangleMesh small = make_sphere(1, 24), large = make_sphere(2, 24);
  RayScene scene;
  REQUIRE(scene.add(small) == 0);
  REQUIRE(scene.add(large) == 1);
  scene.commit();
  std::vector<Hit> hits;
  const Ray ray = ray_along({-5, 0.1, 0.2}, {1, 0, 0});
  for (uint32_t object = 0; object < 2; ++object) {
    scene.all_hits(object, ray, hits);
    REQUIRE(hits.size() == 2);
    CHECK((hits[0].object == object && hits[1].object == object));
    CHECK(scene.closest_point(object, {0, 0, 1.5})->distance == Approx(0.5).epsilon(0.02));
  }
  REQUIRE(scene.nearest(ray));
  CHECK(scene.nearest(ray)->object == 1);
}

TEST_CASE("a hit filter holds for every kind of ray and hears the caller's number", "[ray_scene]") {
  const TriangleMesh plane = make_plane(2, 1);
  RayScene scene;
  scene.add(plane, [](uint32_t, Vec2, double random) { return random < 0.5; });
  scene.commit();
  const Ray ray = ray_along({0.1, 0.2, 1}, {0, 0, -1});
  std::vector<Hit> hits;
  CHECK(scene.nearest(ray, 0.4));
  CHECK_FALSE(scene.nearest(ray, 0.6));
  CHECK(scene.occluded(ray, 0.4));
  CHECK_FALSE(scene.occluded(ray, 0.6));
  scene.all_hits(0, ray, hits, 0.4);
  CHECK(hits.size() == 1);
  scene.all_hits(0, ray, hits, 0.6);
  CHECK(hits.empty());
}

TEST_CASE("the closest point is the brute-force one", "[ray_scene]") {
  TriangleMesh mesh = make_folded_sheet(2, 0.05, 0.02, 10);
  const Vec3 shift(1000, -500, 200);
  translate(mesh, shift);
  const RayScene scene = scene_of(mesh);
  Rng rng(5);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = shift + 2.0 * Vec3(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5);
    double best = std::numeric_limits<double>::infinity();
    for (const Index3& c : mesh.corners) {
      const Triangle triangle{mesh.positions[c[0]], mesh.positions[c[1]], mesh.positions[c[2]]};
      best = std::min(best, glm::length(triangle.point(triangle.closest(p)) - p));
    }
    const auto found = scene.closest_point(0, p);
    REQUIRE(found);
    CHECK(found->distance == best);
    CHECK(glm::length(found->position - p) == Approx(best).epsilon(1e-12));
    CHECK(glm::length(mesh.position(found->triangle, found->barycentric) - found->position) < 1e-12 * 1000);
    CHECK(scene.closest_point(0, p, 1.001 * best));
    CHECK_FALSE(scene.closest_point(0, p, 0.999 * best));
  }
}

TEST_CASE("the closest point of a triangle, region by region", "[ray_scene]") {
  const Triangle t{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto at = [&](double x, double y, double z) { return t.point(t.closest({x, y, z})); };
  CHECK(glm::length(at(1, 1, 5) - Vec3(1, 1, 0)) < 1e-14);
  CHECK(glm::length(at(-1, -1, 2) - Vec3(0, 0, 0)) < 1e-14);
  CHECK(glm::length(at(2, -3, 1) - Vec3(2, 0, 0)) < 1e-14);
  CHECK(glm::length(at(9, -1, 0) - Vec3(4, 0, 0)) < 1e-14);
  CHECK(glm::length(at(3, 3, 1) - Vec3(2, 2, 0)) < 1e-14);
  CHECK(glm::length(at(-2, 7, 0) - Vec3(0, 4, 0)) < 1e-14);
  CHECK(glm::length(at(-2, 1, 0) - Vec3(0, 1, 0)) < 1e-14);
  const Triangle segment{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  CHECK(glm::length(segment.point(segment.closest({1.5, 1, 0})) - Vec3(1.5, 0, 0)) < 1e-14);
  const Triangle dot{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  CHECK(glm::length(dot.point(dot.closest({5, 5, 5})) - Vec3(1, 2, 3)) < 1e-14);
}

TEST_CASE("queries from many threads answer as they do from one", "[ray_scene]") {
  const TriangleMesh mesh = make_torus(1, 0.4, 32);
  const RayScene scene = scene_of(mesh);
  constexpr std::size_t count = 2000;
  const auto ask = [&](std::size_t i) {
    Rng rng(9, i);
    std::vector<Hit> hits;
    const Ray ray = line_through_ball(rng, Vec3(0), 1.5);
    scene.all_hits(0, ray, hits);
    const auto nearest = scene.nearest(ray);
    double sum = static_cast<double>(hits.size()) + (nearest ? nearest->t : 0) + scene.occluded(ray);
    if (const auto closest = scene.closest_point(0, ray.origin)) sum += closest->distance + closest->triangle;
    return sum;
  };
  std::vector<double> answers(count);
  parallel_for(count, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) answers[i] = ask(i);
  });
  for (std::size_t i = 0; i < count; ++i) CHECK(answers[i] == ask(i));
}

TEST_CASE("empty and broken scenes answer nothing", "[ray_scene]") {
  std::vector<Hit> hits{Hit{}};
  RayScene none;
  none.commit();
  CHECK_FALSE(none.nearest(ray_along({0, 0, 0}, {0, 0, 1})));
  TriangleMesh empty, broken = make_plane(1, 2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (Vec3& p : broken.positions) p.x = nan;
  RayScene scene;
  scene.add(empty), scene.add(broken);
  scene.commit();
  CHECK_FALSE(scene.occluded(ray_along({0, 0, 1}, {0, 0, -1})));
  CHECK_FALSE(scene.occluded(ray_along({0, nan, 1}, {0, 0, -1})));
  for (uint32_t object = 0; object < 2; ++object) {
    scene.all_hits(object, ray_along({0, 0, 1}, {0, 0, -1}), hits);
    CHECK(hits.empty());
    CHECK_FALSE(scene.closest_point(object, {0, 0, 0}));
    CHECK_FALSE(scene.closest_point(object, {0, nan, 0}));
  }
}
