#include <catch2/catch.hpp>

#include "bssrdf/body.h"
#include "bssrdf/body_view.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "support/analytic_albedo.h"

using namespace alabaster;

namespace {

PairShape pair_on(Body& body, const SurfacePoint& a, const SurfacePoint& b) {
  const CurvatureField& field = *body.shape()->surface;
  return pair_shape(a.position, PointShape(field.at(a.triangle, a.barycentric), thickest_body), b.position,
                    PointShape(field.at(b.triangle, b.barycentric), thickest_body));
}

// Of the radiosity predicted by the shape basis over that of walks; the errors of the walks beside them.
struct Comparison {
  BodyRadiosity predicted, walked;
};

Comparison compare(const AnalyticBody& body, const Vec3& exit, uint64_t photons) {
  const PointShape shape(body.shape(exit), thickest_body);
  const auto basis = [](const Vec3& xi, const PointShape& si, const Vec3& xe, const PointShape& se,
                        double albedo) {
    const PairShape pair = pair_shape(xi, si, xe, se);
    return baseline_profile().evaluate(albedo, pair.distance) *
           baseline_shapes().factor(pair, Rgb(albedo), Rgb(1)).r;
  };
  const BodyCells cells(body, exit);
  return {predicted_radiosity(cells.cells(), exit, shape, basis), walk_radiosity(body, exit, photons, {})};
}

}  // namespace

TEST_CASE("on a flat mesh with nothing behind, the shape basis is the half-space basis bit for bit",
          "[bssrdf]") {
  TriangleMesh mesh = make_plane(20, 8);
  const Frame turned(glm::normalize(Vec3(0.3, -0.5, 0.8)));
  for (Vec3& p : mesh.positions) p = turned.to_world(p);
  for (Vec3f& n : mesh.normals) n = Vec3f(turned.to_world(Vec3(n)));
  Body body(mesh);
  const CosineAlbedo albedo(Rgb(0.6, 0.5, 0.9), Rgb(0.3, 0.4, 0.09), {2, 1});
  BssrdfOptions options;
  options.placement = &body.placement;
  for (const Rgb sigma_t : {Rgb(1), Rgb(0.3, 1, 4)}) {
    const BssrdfMedium half_space{&baseline_profile(), sigma_t, &albedo};
    const BssrdfMedium shape{&baseline_profile(), sigma_t, &albedo, body.shape()};
    const std::vector<SurfacePoint> points = points_on(body.mesh, 200, 5);
    for (const char* name : all_models) {
      const auto plain = make_bssrdf(name, half_space, options), shaped = make_bssrdf(name, shape, options);
      for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        const Rgb a = plain->evaluate(half_space.point(points[k]), half_space.point(points[k + 1]));
        const Rgb b = shaped->evaluate(shape.point(points[k]), shape.point(points[k + 1]));
        REQUIRE(a == b);
      }
    }
  }
}

TEST_CASE("pairs on a sphere, in a cavity and on a slab are recognised", "[bssrdf]") {
  Body sphere(make_sphere(3, 96)), cavity(make_cavity(3, 20, 96)), slab(make_slab(40, 2, 20));
  const auto at = [](const Body& body, const Vec3& p) {
    const auto closest = body.rays.closest_point(0, p);
    return body.mesh.surface_point(closest->triangle, closest->barycentric);
  };
  Rng rng(5);
  for (int k = 0; k < 100; ++k) {
    const Vec3 u = glm::normalize(Vec3(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5));
    const Vec3 v = glm::normalize(Vec3(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5));
    const PairShape ball = pair_on(sphere, at(sphere, 3.0 * u), at(sphere, 3.0 * v));
    CHECK(ball.curvature == Approx(1.0 / 3).epsilon(0.02));
    CHECK(ball.sphericity > 0.97);
    const PairShape hole = pair_on(cavity, at(cavity, 3.0 * u), at(cavity, 3.0 * v));
    CHECK(hole.curvature == Approx(-1.0 / 3).epsilon(0.02));
    CHECK(hole.sphericity > 0.97);
    const Vec3 a(8 * u.x, 1, 8 * u.z), b(8 * v.x, k % 2 ? 1 : -1, 8 * v.z);
    const PairShape sheet = pair_on(slab, at(slab, a), at(slab, b));
    CHECK(sheet.inverse_thickness == Approx(0.5).epsilon(1e-5));
    CHECK(sheet.sphericity < 1e-6);
    CHECK(sheet.far == Approx(k % 2 ? 0 : 1).margin(1e-9));
    if (k % 2 == 0) CHECK(sheet.lateral == Approx(std::hypot(a.x - b.x, a.z - b.z)).epsilon(1e-3));
  }
}

TEST_CASE("the shape of a pair does not depend on its order", "[bssrdf]") {
  Body body(make_blob(5, 0.25, 48));
  const std::vector<SurfacePoint> points = points_on(body.mesh, 60, 7);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const PairShape a = pair_on(body, points[k], points[k + 1]), b = pair_on(body, points[k + 1], points[k]);
    CHECK(a.curvature == Approx(b.curvature).margin(1e-12));
    CHECK(a.sphericity == b.sphericity);
    CHECK(a.lateral == Approx(b.lateral).margin(1e-9));
    CHECK(a.far == b.far);
    CHECK(a.inverse_thickness == b.inverse_thickness);
  }
}

TEST_CASE(
    "far away, light spreads over the larger surface that wrinkles make, continuously and at both ends alike",
    "[bssrdf]") {
  LocalShape flat;
  flat.normal = Vec3(0, 0, 1);
  LocalShape rough = flat;
  rough.roughness = 0.2;
  const PointShape smooth(flat, thickest_body), wrinkled(rough, thickest_body);
  const auto reach = [](double d, const PointShape& a, const PointShape& b) {
    return pair_shape(Vec3(d, 0, 0), a, Vec3(0), b).reach;
  };
  CHECK(reach(10, smooth, smooth) == 1);
  CHECK(reach(10, wrinkled, wrinkled) == Approx(std::exp(-0.1)));  // 1 / (1 + roughness / 2), nearly
  CHECK(reach(10, smooth, wrinkled) == reach(10, wrinkled, smooth));
  CHECK(reach(10, smooth, wrinkled) * reach(10, smooth, wrinkled) == Approx(reach(10, wrinkled, wrinkled)));
  double before = 1;
  for (int k = 1; k <= 300; ++k) {
    const double now = reach(0.01 * k, wrinkled, wrinkled);
    CHECK(now <= before);
    CHECK(before - now < 0.001);
    before = now;
  }
  CHECK(reach(1e-3, wrinkled, wrinkled) == Approx(1).epsilon(1e-6));
}

TEST_CASE("radiosity of spheres and slabs within 2 % of walks in them, of others within their goals",
          "[bssrdf]") {
  struct Case {
    AnalyticBody body;
    Vec3 exit;
    double goal;
  };
  const Case cases[] = {{make_ellipsoid_body("sphere 3", Vec3(3)), Vec3(3, 0.3, 0.2), 0.02},
                        {make_slab_body("slab 2", 2, 40), Vec3(0.01, 0.02, 0), 0.02},
                        {make_ellipsoid_body("prolate 10", Vec3(10, 30, 10)), Vec3(10, 1, 0.5), 0.03},
                        {make_ellipsoid_body("oblate 3, flat", Vec3(9, 3, 9)), Vec3(0.1, 3, 0.1), 0.08},
                        {make_torus_body("torus 9 / 3, outside", 9, 3), Vec3(12, 0.01, 0.02), 0.08},
                        {make_cavity_body("cavity 3", 3), Vec3(3, 0.3, 0.2), 0.03},
                        {make_blob_body("blob 10", 10, 0.2), Vec3(1, 2, 10), 0.08}};
  for (const Case& c : cases) {
    const Comparison result = compare(c.body, c.body.onto(c.exit), 15000);
    for (std::size_t a = 1; a < body_albedos.size(); ++a)
      for (std::size_t l = 0; l < 2; ++l) {
        const double walked = result.walked.value[a][l], error = result.walked.standard_error[a][l];
        INFO(c.body.name << " albedo " << body_albedos[a] << " light " << l << ": "
                         << result.predicted.value[a][l] << " against " << walked << " +- " << error);
        // The quadrature itself is good to 1 %.
        CHECK(std::abs(result.predicted.value[a][l] - walked) < (c.goal + 0.01) * walked + 3.5 * error);
      }
  }
}

TEST_CASE("images under one-sided light: within 4 % of walks by light's aim, 10 % too bright without",
          "[bssrdf]") {
  const Vec3 camera(0, 0.15, 1), key(-0.6, 0.62, 0.5);
  const std::size_t a = 1;
  const double albedo = body_albedos[a];
  for (const AnalyticBody& body :
       {make_ellipsoid_body("sphere 3", Vec3(3)), make_torus_body("torus 9 / 3", 9, 3)}) {
    const BodyView view = make_view(body, camera, key, 30);
    const Sky sky{0.15, 3, view.key};
    const Entering entering(sky, Lobe());
    const SkyDirections directions(sky);
    double walked = 0, variance = 0, mean = 0, aimed = 0;
    for (std::size_t i = 0; i < view.exits.size(); ++i) {
      const Vec3 xe = view.exits[i], n = body.normal(xe);
      const double share = view.share[i] * (1 - fresnel_dielectric(glm::dot(n, view.camera), 1.5));
      RunningMoments light;
      const int photons = 1500;
      walk_pixel(view, xe, false, photons, i, [&](int64_t order, const Vec3&, const Vec3& w) {
        light.add(std::pow(albedo, static_cast<double>(order)) * sky.radiance(w));
      });
      while (light.count() < photons) light.add(0);
      walked += share * light.mean();
      variance += share * share * light.variance_of_mean();
      const PointShape at_exit(body.shape(xe), thickest_body);
      const BodyCells cells(body, xe);
      for (const BodyCell& cell : cells.cells()) {
        const PairShape pair = pair_shape(cell.position, cell.shape, xe, at_exit);
        const double s = cell.area * baseline_profile().evaluate(albedo, pair.distance) *
                         baseline_shapes().factor(pair, Rgb(albedo), Rgb(1)).r;
        const double light = share * s * entering.at(glm::dot(cell.shape.normal, view.key));
        const LightAim aim(baseline_shapes().aim(pair, Rgb(albedo), Rgb(1)), cell.position, cell.shape.normal,
                           xe, n, view.camera);
        mean += light;
        aimed += light * directions.mean(aim, true, cell.shape.normal);
      }
    }
    INFO(body.name << ": " << walked << " +- " << std::sqrt(variance) << ", by the basis " << aimed
                   << ", without aim " << mean);
    CHECK(std::abs(aimed - walked) < 0.04 * walked + 3.5 * std::sqrt(variance));
    CHECK(mean > 1.1 * walked - 3.5 * std::sqrt(variance));
  }
}
