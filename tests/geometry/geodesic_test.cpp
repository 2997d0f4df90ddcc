#include "geometry/geodesic.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "core/rng.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "support/nasty_meshes.h"

using namespace alabaster;

namespace {

/// A mesh with every method on it.
struct Methods {
  explicit Methods(TriangleMesh m) : mesh(std::move(m)), half_edges(mesh) {
    scene.add(mesh);
    scene.commit();
    chord = make_chord(mesh, scene, 0);
    corrected = make_normal_corrected_chord(mesh, scene, 0);
    projected = make_projected_chord(mesh, scene, 0);
    straightest = make_straightest_path(mesh, half_edges);
    graph = make_edge_graph(mesh, half_edges);
    heat = make_heat_method(mesh, half_edges);
  }
  SurfacePoint random_point(Rng& rng) const {
    const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
    const double r = std::sqrt(rng.uniform());
    return mesh.surface_point(t, {r * rng.uniform(), 1 - r});
  }
  SurfacePoint at(const Vec3& p) const {
    const auto closest = scene.closest_point(0, p);
    return mesh.surface_point(closest->triangle, closest->barycentric);
  }
  std::vector<const Geodesic*> all() const {
    return {chord.get(), corrected.get(), projected.get(), straightest.get(), graph.get(), heat.get()};
  }
  std::vector<const GeodesicPath*> paths() const {
    return {chord.get(), corrected.get(), projected.get(), straightest.get()};
  }

  TriangleMesh mesh;
  HalfEdgeMesh half_edges;
  RayScene scene;
  std::unique_ptr<GeodesicPath> chord, corrected, projected, straightest;
  std::unique_ptr<Geodesic> graph, heat;
};

/// Relative errors of a method over random pairs at least `shortest` apart; pairs the method gives up on are
/// counted apart.
struct Errors {
  double mean_absolute = 0, worst = 0;
  int answered = 0, refused = 0;
};

Errors errors_of(const Geodesic& method, const Methods& methods,
                 const std::function<double(const Vec3&, const Vec3&)>& exact, double shortest,
                 double longest, int pairs = 200) {
  Rng rng(21);
  Errors errors;
  while (errors.answered + errors.refused < pairs) {
    const SurfacePoint a = methods.random_point(rng), b = methods.random_point(rng);
    const double expected = exact(a.position, b.position);
    if (!(expected >= shortest && expected <= longest)) continue;
    const auto distance = method.distance(a, b);
    if (!distance) {
      ++errors.refused;
      continue;
    }
    ++errors.answered;
    const double error = std::abs(*distance / expected - 1);
    errors.worst = std::max(errors.worst, error);
    errors.mean_absolute += error;
  }
  errors.mean_absolute /= std::max(errors.answered, 1);
  return errors;
}

double on_unit_sphere(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// Around a cylinder of radius 1 about y, away from the caps.
double on_unit_cylinder(const Vec3& a, const Vec3& b) {
  if (std::max(std::abs(a.y), std::abs(b.y)) > 1.9) return std::numeric_limits<double>::quiet_NaN();
  const double angle = std::abs(std::remainder(std::atan2(a.z, a.x) - std::atan2(b.z, b.x), 2 * pi));
  return std::hypot(angle, a.y - b.y);
}

}  // namespace

TEST_CASE("on a plane the chords and the straightest path are exact", "[geodesic]") {
  const Methods plane(make_plane(2, 24));
  const auto exact = [](const Vec3& a, const Vec3& b) { return glm::length(a - b); };
  for (const GeodesicPath* method : plane.paths()) {
    INFO(method->name());
    const Errors errors = errors_of(*method, plane, exact, 0.01, 3);
    CHECK(errors.worst < 1e-6);
    CHECK(errors.refused == 0);
  }
  const Errors graph = errors_of(*plane.graph, plane, exact, 0.3, 3);
  CHECK(graph.worst < 0.5);
  const Errors heat = errors_of(*plane.heat, plane, exact, 0.3, 3);
  CHECK(heat.mean_absolute < 0.03);
  Rng rng(22);
  for (int i = 0; i < 100; ++i) {
    const SurfacePoint a = plane.random_point(rng), b = plane.random_point(rng);
    CHECK(*plane.graph->distance(a, b) >= glm::length(a.position - b.position) - 1e-12);
    for (const GeodesicPath* method : plane.paths())
      for (const double t : {0.0, 1.0 / 7, 4.0 / 7, 1.0}) {
        INFO(method->name());
        const auto point = method->between(a, b, t);
        REQUIRE(point);
        CHECK(glm::length(point->position - glm::mix(a.position, b.position, t)) < 1e-6);
      }
  }
}

TEST_CASE("on a sphere", "[geodesic]") {
  const Methods sphere(make_blob(1, 0, 96));
  const double h = 2 * pi / 96;
  const Errors chord = errors_of(*sphere.chord, sphere, on_unit_sphere, 0.1, 1.5);
  CHECK(chord.worst == Approx(1 - std::sin(0.75) / 0.75).epsilon(0.1));
  // Exact up to the facets: positions and interpolated normals are off by h^2 / 8.
  const Errors corrected = errors_of(*sphere.corrected, sphere, on_unit_sphere, 0.1, 3);
  CHECK(corrected.worst < h * h);
  CHECK(corrected.refused == 0);
  const Errors projected = errors_of(*sphere.projected, sphere, on_unit_sphere, 0.1, 1.5);
  CHECK(projected.worst < 0.03);
  CHECK(projected.refused == 0);
  const Errors straightest = errors_of(*sphere.straightest, sphere, on_unit_sphere, 0.1, 1.5);
  CHECK(straightest.worst < 2 * h * h);
  CHECK(straightest.refused <= 2);
  const Errors graph = errors_of(*sphere.graph, sphere, on_unit_sphere, 0.3, 3);
  CHECK(graph.mean_absolute < 0.12);
  const Errors heat = errors_of(*sphere.heat, sphere, on_unit_sphere, 0.3, 3, 60);
  CHECK(heat.mean_absolute < 0.02);
}

TEST_CASE("on a cylinder", "[geodesic]") {
  const Methods cylinder(make_cylinder(1, 4, 96));
  const Errors straightest = errors_of(*cylinder.straightest, cylinder, on_unit_cylinder, 0.1, 1.2);
  CHECK(straightest.worst < 0.002);
  CHECK(straightest.refused <= 2);
  // The angle is shared between the directions: what is left is of fourth order.
  const Errors chord = errors_of(*cylinder.chord, cylinder, on_unit_cylinder, 0.1, 1.2);
  const Errors corrected = errors_of(*cylinder.corrected, cylinder, on_unit_cylinder, 0.1, 1.2);
  CHECK(corrected.worst < 0.25 * chord.worst);
  const Errors heat = errors_of(*cylinder.heat, cylinder, on_unit_cylinder, 0.3, 1.2, 60);
  CHECK(heat.mean_absolute < 0.03);
}

TEST_CASE("on a cone, unrolled", "[geodesic]") {
  // Apex at the origin, half-angle 30 degrees: unrolled it is half a disk (sin 30 = 1/2).
  constexpr uint32_t around = 96, along = 32;
  std::vector<Vec3> positions{{0, 0, 0}};
  std::vector<Index3> corners;
  for (uint32_t j = 1; j <= along; ++j)
    for (uint32_t i = 0; i < around; ++i) {
      const double r = 2.0 * j / along, phi = 2 * pi * i / around;
      positions.push_back({0.5 * r * std::cos(phi), 0.5 * r * std::sin(phi), -r * std::sqrt(0.75)});
      const uint32_t next = (i + 1) % around, ring = 1 + (j - 1) * around, below = ring - around;
      if (j == 1) {
        corners.push_back({0, ring + i, ring + next});
      } else {
        corners.push_back({below + i, ring + i, ring + next});
        corners.push_back({below + i, ring + next, below + next});
      }
    }
  const Methods cone(nasty::from(std::move(positions), std::move(corners)));
  // Away from the rim and the apex, at most a third of the way around: no way over the apex is shorter.
  const auto exact = [](const Vec3& a, const Vec3& b) {
    const double ra = glm::length(a), rb = glm::length(b);
    const double phi = std::abs(std::remainder(std::atan2(a.y, a.x) - std::atan2(b.y, b.x), 2 * pi));
    if (std::min(ra, rb) < 0.4 || std::max(ra, rb) > 1.9 || phi > 2) return -1.0;
    return std::sqrt(ra * ra + rb * rb - 2 * ra * rb * std::cos(0.5 * phi));
  };
  const double step = 2 * pi / around;
  const Errors straightest = errors_of(*cone.straightest, cone, exact, 0.1, 1.2);
  CHECK(straightest.worst < step * step);
  CHECK(straightest.refused <= 2);
  CHECK(errors_of(*cone.heat, cone, exact, 0.3, 1.2, 60).mean_absolute < 0.03);
  CHECK(errors_of(*cone.projected, cone, exact, 0.1, 0.8).mean_absolute < 0.01);
}

TEST_CASE("on a torus, along the circles that are geodesics", "[geodesic]") {
  const double ring = 1, tube = 0.4;
  const Methods torus(make_torus(ring, tube, 160));
  const auto at = [&](double theta, double phi) {  // around the axis, around the tube
    const double rho = ring + tube * std::cos(phi);
    return torus.at({rho * std::cos(theta), tube * std::sin(phi), rho * std::sin(theta)});
  };
  Rng rng(26);
  for (int i = 0; i < 50; ++i) {
    const double theta = 2 * pi * rng.uniform(), phi = 2 * pi * rng.uniform(),
                 turn = 0.2 + 0.8 * rng.uniform();
    const SurfacePoint start = at(theta, phi), around_tube = at(theta, phi + turn);
    const SurfacePoint outer = at(theta, 0), along_equator = at(theta + 0.5 * turn, 0);
    for (const Geodesic* method : {torus.corrected.get(), torus.straightest.get(), torus.projected.get()}) {
      INFO(method->name());
      const auto meridian = method->distance(start, around_tube),
                 equator = method->distance(outer, along_equator);
      REQUIRE((meridian && equator));
      CHECK(*meridian == Approx(tube * turn).epsilon(0.02));
      CHECK(*equator == Approx((ring + tube) * 0.5 * turn).epsilon(0.02));
    }
  }
}

TEST_CASE("the straightest path and the heat method converge under refinement", "[geodesic]") {
  const Methods coarse(make_blob(1, 0, 24)), fine(make_blob(1, 0, 96));
  const auto ratio = [&](auto method) {
    return errors_of(*(coarse.*method), coarse, on_unit_sphere, 0.4, 1.2, 60).mean_absolute /
           errors_of(*(fine.*method), fine, on_unit_sphere, 0.4, 1.2, 60).mean_absolute;
  };
  CHECK(ratio(&Methods::straightest) > 8);  // second order: 16
  CHECK(ratio(&Methods::heat) > 2);         // first order: 4
}

TEST_CASE("the halfway point is halfway on a sphere", "[geodesic]") {
  const Methods sphere(make_blob(1, 0, 96));
  Rng rng(23);
  int checked = 0;
  while (checked < 200) {
    const SurfacePoint a = sphere.random_point(rng), b = sphere.random_point(rng);
    const double angle = on_unit_sphere(a.position, b.position);
    if (angle < 0.1 || angle > 1.2) continue;
    ++checked;
    for (const GeodesicPath* method : {sphere.corrected.get(), sphere.straightest.get()})
      for (const double t : {1.0 / 7, 2.0 / 7, 4.0 / 7}) {
        const auto point = method->between(a, b, t);
        if (!point) continue;
        INFO(method->name());
        CHECK(on_unit_sphere(a.position, point->position) == Approx(t * angle).margin(0.01));
        CHECK(on_unit_sphere(point->position, b.position) == Approx((1 - t) * angle).margin(0.01));
      }
  }
}

TEST_CASE("what claims symmetry is symmetric, the graph keeps the triangle inequality", "[geodesic]") {
  const Methods blob(make_blob(1, 0.2, 32));
  Rng rng(24);
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint a = blob.random_point(rng), b = blob.random_point(rng);
    const std::array<const Geodesic*, 3> symmetric{blob.chord.get(), blob.corrected.get(), blob.graph.get()};
    for (const Geodesic* method : symmetric) {
      INFO(method->name());
      CHECK(*method->distance(a, b) == Approx(*method->distance(b, a)).epsilon(1e-12));
      CHECK(*method->distance(a, b) >= *blob.chord->distance(a, b) - 1e-12);
    }
    // At a vertex the way through it is one of those the graph compares.
    SurfacePoint via = blob.random_point(rng);
    via = blob.mesh.surface_point(via.triangle, {0, 0});
    CHECK(*blob.graph->distance(a, b) <=
          *blob.graph->distance(a, via) + *blob.graph->distance(via, b) + 1e-12);
  }
}

TEST_CASE("the Steiner graph is never short and closes in as points are added", "[geodesic]") {
  const TriangleMesh plane = make_plane(2, 6), ball = make_blob(1, 0, 24);
  Rng rng(8);
  const auto on_the_ball = static_cast<uint32_t>(ball.triangle_count());
  double last_plane = 1, last_ball = 1;
  for (const int per_edge : {0, 2, 6}) {
    const auto on_plane = make_steiner_graph(plane, per_edge), on_ball = make_steiner_graph(ball, per_edge);
    double mean_plane = 0, mean_ball = 0;
    const SurfacePoint from = plane.surface_point(9, {0.3, 0.3}),
                       from_ball = ball.surface_point(9, {0.3, 0.3});
    int count = 0;
    for (uint32_t t = 0; t < plane.triangle_count(); t += 3) {
      const SurfacePoint to = plane.surface_point(t, {0.2, 0.2}),
                         to_ball = ball.surface_point((7 * t) % on_the_ball, {0.2, 0.2});
      const double exact = glm::distance(from.position, to.position),
                   exact_ball = on_unit_sphere(from_ball.position, to_ball.position);
      if (exact < 0.3 || exact_ball < 0.3) continue;
      ++count;
      CHECK(*on_plane->distance(from, to) >= exact * (1 - 1e-12));
      mean_plane += *on_plane->distance(from, to) / exact - 1;
      mean_ball += std::abs(*on_ball->distance(from_ball, to_ball) / exact_ball - 1);
    }
    CHECK(mean_plane / count < 0.6 * last_plane);
    CHECK(mean_ball / count < 0.6 * last_ball);
    last_plane = mean_plane / count, last_ball = mean_ball / count;
  }
  CHECK(last_plane < 0.01);
  CHECK(last_ball < 0.015);
}

TEST_CASE("unreachable points are answered as such", "[geodesic]") {
  TriangleMesh pair = make_sphere(1, 16);
  const TriangleMesh other = make_sphere(1, 16);
  const auto base = static_cast<uint32_t>(pair.positions.size());
  const auto attribute_base = static_cast<uint32_t>(pair.normals.size());
  for (const Vec3& p : other.positions) pair.positions.push_back(p + Vec3(2.01, 0, 0));
  for (const Index3& c : other.corners) pair.corners.push_back({base + c[0], base + c[1], base + c[2]});
  for (const Index3& c : other.attributes)
    pair.attributes.push_back({attribute_base + c[0], attribute_base + c[1], attribute_base + c[2]});
  pair.normals.insert(pair.normals.end(), other.normals.begin(), other.normals.end());
  pair.uv_sets.clear();
  const Methods balls(pair);
  const SurfacePoint left = balls.at({0.9, 0.1, 0}), right = balls.at({1.2, 0.1, 0}),
                     top = balls.at({0, 1, 0});
  CHECK_FALSE(balls.graph->distance(left, right));
  CHECK_FALSE(balls.heat->distance(left, right));
  CHECK_FALSE(balls.straightest->distance(left, right));
  CHECK(balls.graph->distance(left, top));
  CHECK(balls.heat->distance(left, top));

  const Methods slab(make_slab(2, 0.02, 24));  // the other side is near through, far around
  const SurfacePoint above = slab.at({0.1, 0.01, 0.1}), below = slab.at({0.12, -0.01, 0.1});
  CHECK_FALSE(slab.straightest->distance(above, below));
  CHECK(*slab.graph->distance(above, below) > 1.5);
  CHECK(*slab.heat->distance(above, below) > 1);
}

TEST_CASE("identical points, needles and nasty meshes", "[geodesic]") {
  TriangleMesh needles = make_plane(1, 8);  // squashed: angles of a tenth of a degree
  for (Vec3& p : needles.positions) p.x *= 1e-3;
  TriangleMesh band = nasty::moebius();
  clean_mesh(band);
  for (const TriangleMesh& mesh : {needles, nasty::single_triangle(), nasty::tetrahedron(), nasty::book(),
                                   nasty::two_at_an_edge(), nasty::bow_tie(), band}) {
    const Methods methods(mesh);
    Rng rng(25);
    for (int i = 0; i < 20; ++i) {
      const SurfacePoint a = methods.random_point(rng), b = methods.random_point(rng);
      for (const Geodesic* method : methods.all()) {
        INFO(method->name());
        CHECK(method->distance(a, a).value_or(0) == Approx(0).margin(1e-12));
        const auto distance = method->distance(a, b);
        CHECK((!distance || (std::isfinite(*distance) && *distance >= 0)));
      }
      for (const GeodesicPath* method : methods.paths()) {
        const auto point = method->between(a, b, 0.5);
        CHECK((!point || std::isfinite(glm::length(point->position))));
      }
    }
  }
}
