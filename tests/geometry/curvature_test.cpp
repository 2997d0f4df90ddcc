#include "geometry/curvature.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "core/rng.h"
#include "geometry/half_edge_mesh.h"
#include "geometry/shapes.h"
#include "support/nasty_meshes.h"

using namespace alabaster;

namespace {

struct Shaped {
  explicit Shaped(TriangleMesh m, const CurvatureOptions& options = {}) : mesh(std::move(m)) {
    scene.add(mesh);
    scene.commit();
    field = CurvatureField(mesh, scene, 0, options);
  }
  TriangleMesh mesh;
  RayScene scene;
  CurvatureField field;
};

/// Visits the middle of every triangle.
void for_each_centre(const Shaped& shaped,
                     const std::function<void(const SurfacePoint&, const LocalShape&)>& visit) {
  for (uint32_t t = 0; t < shaped.mesh.triangle_count(); ++t)
    visit(shaped.mesh.surface_point(t, Vec2(1.0 / 3)), shaped.field.at(t, Vec2(1.0 / 3)));
}

/// Largest relative error of a quantity over the triangles; `expected` returns NaN where it does not apply.
double worst_error(const Shaped& shaped, double scale,
                   const std::function<double(const LocalShape&)>& quantity,
                   const std::function<double(const Vec3&)>& expected) {
  double worst = 0;
  int counted = 0;
  for_each_centre(shaped, [&](const SurfacePoint& point, const LocalShape& shape) {
    const double wanted = expected(point.position);
    if (std::isnan(wanted)) return;
    worst = std::max(worst, std::abs(quantity(shape) - wanted) / scale);
    ++counted;
  });
  REQUIRE(counted > 40);
  return worst;
}

constexpr double not_here = std::numeric_limits<double>::quiet_NaN();
double smaller(const LocalShape& s) {
  return s.curvature_min;
}
double larger(const LocalShape& s) {
  return s.curvature_max;
}
double inverse_thickness(const LocalShape& s) {
  return s.inverse_thickness;
}

}  // namespace

TEST_CASE("a plane is flat and endless, however it is turned", "[curvature]") {
  TriangleMesh plane = make_plane(2, 12);
  for (Vec3& p : plane.positions) p = {0.6 * p.x + 3, p.y - 1, 0.8 * p.x + 2};
  const Shaped shaped(plane);
  for_each_centre(shaped, [&](const SurfacePoint& point, const LocalShape& shape) {
    CHECK(std::max(std::abs(shape.curvature_min), std::abs(shape.curvature_max)) < 1e-12);
    CHECK(shape.inverse_thickness == 0);
    CHECK(glm::length(shape.normal - point.geometric_normal) < 1e-6);
  });
}

TEST_CASE("spheres, from outside and from inside, by any tessellation", "[curvature]") {
  const int segments = 48;
  const double tolerance = (2 * pi / segments) * (2 * pi / segments);  // second order in the edge
  for (const double radius : {0.01, 3.0})
    for (int kind = 0; kind < 3; ++kind) {
      INFO("radius " << radius << ", kind " << kind);
      const Shaped shaped(kind == 0   ? make_sphere(radius, segments)
                          : kind == 1 ? make_blob(radius, 0, segments)
                                      : make_ellipsoid(Vec3(radius), segments));
      const auto one_over_r = [&](const Vec3&) { return 1 / radius; };
      CHECK(worst_error(shaped, 1 / radius, smaller, one_over_r) < tolerance);
      CHECK(worst_error(shaped, 1 / radius, larger, one_over_r) < tolerance);
      const auto one_over_2r = [&](const Vec3&) { return 0.5 / radius; };  // through the centre
      CHECK(worst_error(shaped, 0.5 / radius, inverse_thickness, one_over_2r) < tolerance);
    }
  const Shaped cavity(make_cavity(1, 3, 48));
  const auto on_ball = [](const Vec3& p) { return glm::length(p) < 1.01 ? -1.0 : not_here; };
  CHECK(worst_error(cavity, 1, smaller, on_ball) < 0.02);
  CHECK(worst_error(cavity, 1, larger, on_ball) < 0.02);
}

TEST_CASE("a cylinder has its radius one way and none the other", "[curvature]") {
  const Shaped shaped(make_cylinder(0.5, 4, 64));
  const auto on_side = [](double value) {
    return [value](const Vec3& p) {
      return std::abs(p.y) < 1.5 && std::hypot(p.x, p.z) > 0.49 ? value : not_here;
    };
  };
  CHECK(worst_error(shaped, 2, smaller, on_side(0)) < 0.01);
  CHECK(worst_error(shaped, 2, larger, on_side(2)) < 0.01);
  CHECK(worst_error(shaped, 1, inverse_thickness, on_side(1)) < 0.01);
}

TEST_CASE("a torus, its saddle included", "[curvature]") {
  const double ring = 1, tube = 0.4;
  const Shaped shaped(make_torus(ring, tube, 160));
  const auto along_ring = [&](const Vec3& p) {
    const double rho = std::hypot(p.x, p.z);
    return (rho - ring) / tube / rho;  // cos(phi) / (ring + tube cos(phi))
  };
  CHECK(worst_error(shaped, 1 / tube, smaller, along_ring) < 0.03);
  CHECK(worst_error(shaped, 1 / tube, larger, [&](const Vec3&) { return 1 / tube; }) < 0.03);
  CHECK(worst_error(shaped, 0.5 / tube, inverse_thickness, [&](const Vec3&) { return 0.5 / tube; }) < 0.03);
}

TEST_CASE("a slab is flat and as thick as it is", "[curvature]") {
  const Shaped shaped(make_slab(4, 0.2, 32));
  const auto on_face = [](double value) {
    return [value](const Vec3& p) { return std::max(std::abs(p.x), std::abs(p.z)) < 1.4 ? value : not_here; };
  };
  CHECK(worst_error(shaped, 1, smaller, on_face(0)) < 1e-9);
  CHECK(worst_error(shaped, 1, larger, on_face(0)) < 1e-9);
  CHECK(worst_error(shaped, 5, inverse_thickness, on_face(5)) < 1e-5);
}

TEST_CASE("the shape scales with the object", "[curvature]") {
  TriangleMesh blob = make_blob(1, 0.1, 24), large = blob;
  for (Vec3& p : large.positions) p = p * 1024.0 + Vec3(4096, 0, 0);
  const Shaped a(blob), b(large);
  for (uint32_t t = 0; t < blob.triangle_count(); ++t) {
    const LocalShape p = a.field.at(t, {0.2, 0.2}), q = b.field.at(t, {0.2, 0.2});
    CHECK(q.curvature_min * 1024 == Approx(p.curvature_min).margin(1e-5));
    CHECK(q.curvature_max * 1024 == Approx(p.curvature_max).margin(1e-5));
    CHECK(q.inverse_thickness * 1024 == Approx(p.inverse_thickness).epsilon(1e-4));
  }
}

TEST_CASE("noise on the vertices is averaged away by a wider neighbourhood", "[curvature]") {
  // A unit sphere, edges of 0.06, every vertex moved along the radius by 0.005 (standard deviation): facet
  // normals are off by 8 degrees.
  TriangleMesh noisy = make_blob(1, 0, 96);
  Rng rng(11);
  for (Vec3& p : noisy.positions) {
    const double gaussian =
        std::sqrt(-2 * std::log(rng.uniform_positive())) * std::cos(2 * pi * rng.uniform());
    p *= 1 + 0.005 * gaussian;
  }
  const auto rms_error = [](const Shaped& shaped) {
    double sum = 0;
    for_each_centre(shaped, [&](const SurfacePoint&, const LocalShape& shape) {
      sum += (shape.mean_curvature() - 1) * (shape.mean_curvature() - 1);
    });
    return std::sqrt(sum / static_cast<double>(shaped.mesh.triangle_count()));
  };
  CurvatureOptions wide;
  wide.radius = 0.4, wide.max_neighbours = 400;
  const double narrow_error = rms_error(Shaped(noisy)), wide_error = rms_error(Shaped(noisy, wide));
  INFO("rms error of the mean curvature: " << narrow_error << " at three edges, " << wide_error << " at six");
  CHECK(narrow_error < 0.5);
  // The slope's error falls as radius^-2 (more vertices, longer arms).
  CHECK(wide_error < narrow_error / 2.5);
}

TEST_CASE("wrinkles are rough, spheres and planes are not", "[curvature]") {
  CurvatureOptions options;
  options.coarse_radius = 0.5;
  options.max_neighbours = 1000;
  for_each_centre(Shaped(make_sphere(1, 64), options), [](const SurfacePoint&, const LocalShape& shape) {
    CHECK(std::abs(shape.roughness) < 2e-4);
  });
  TriangleMesh sheet = make_plane(1.6, 100);
  for_each_centre(Shaped(sheet, options),
                  [](const SurfacePoint&, const LocalShape& shape) { CHECK(shape.roughness == 0); });
  // z = h sin(k x): the mean square of the slope is h^2 k^2 / 2, of which the vertices' normals, means over
  // their triangles, and the fit take a part.
  const double frequency = 2 * pi / 0.15;
  const auto waves = [&](double height) {
    TriangleMesh wavy = sheet;
    for (Vec3& p : wavy.positions) p.z += height * std::sin(frequency * p.x);
    double sum = 0;
    int count = 0;
    for_each_centre(Shaped(wavy, options), [&](const SurfacePoint& point, const LocalShape& shape) {
      if (std::abs(point.position.x) < 0.3 && std::abs(point.position.y) < 0.3)
        sum += shape.roughness, ++count;
    });
    return sum / count / (0.5 * height * height * frequency * frequency);
  };
  const double low = waves(0.002), high = waves(0.004);
  CHECK(low < 1);
  CHECK(low > 0.7);
  CHECK(high == Approx(low).epsilon(0.05));
  // Without a radius nothing is measured.
  for_each_centre(Shaped(sheet),
                  [](const SurfacePoint&, const LocalShape& shape) { CHECK(shape.roughness == 0); });
}

TEST_CASE("a coarse, faceted sphere is still a sphere", "[curvature]") {
  const Shaped shaped(make_blob(1, 0, 8));
  CHECK(worst_error(shaped, 1, smaller, [](const Vec3&) { return 1.0; }) < 0.1);
  CHECK(worst_error(shaped, 1, larger, [](const Vec3&) { return 1.0; }) < 0.1);
}

TEST_CASE("nasty meshes have finite shapes", "[curvature]") {
  TriangleMesh band = nasty::moebius();
  clean_mesh(band);
  for (const TriangleMesh& mesh : {nasty::single_triangle(), nasty::tetrahedron(), nasty::book(),
                                   nasty::two_at_an_edge(), nasty::bow_tie(), band, TriangleMesh{}}) {
    const Shaped shaped(mesh);
    CHECK(shaped.field.empty() == mesh.corners.empty());
    for_each_centre(shaped, [&](const SurfacePoint&, const LocalShape& shape) {
      CHECK(std::isfinite(shape.curvature_min));
      CHECK(std::isfinite(shape.curvature_max));
      CHECK(std::isfinite(shape.inverse_thickness));
      CHECK(glm::length(shape.normal) == Approx(1));
    });
  }
}
