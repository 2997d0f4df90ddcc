#include "bssrdf/surface_distance.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "bssrdf/aggregation_kernel.h"
#include "bssrdf/body.h"
#include "bssrdf/bssrdf.h"
#include "core/error.h"
#include "geometry/shapes.h"
#include "support/analytic_albedo.h"
#include "support/analytic_profile.h"

using namespace alabaster;

TEST_CASE("the basis may be asked for the way over the surface, the kernel keeps the chord", "[bssrdf]") {
  const Body body(make_sphere(1, 128));
  const AnalyticProfile profile;
  const CosineAlbedo albedo(Rgb(0.6), Rgb(0.3), {2, 1});
  const BssrdfMedium by_chord{&profile, Rgb(3), &albedo};
  BssrdfOptions options;
  options.placement = &body.placement;
  CHECK(make_surface_distance("chord", body.parts()) == nullptr);
  CHECK_THROWS_AS(make_surface_distance("crow", body.parts()), InputError);
  for (const char* name : {"normal-corrected", "geodesic"}) {
    const auto distance = make_surface_distance(name, body.parts());
    BssrdfMedium medium = by_chord;
    medium.distance = distance.get();
    const auto model = make_bssrdf("composite", medium, options);
    const auto points = points_on(body.mesh, 60, 3);
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const BssrdfPoint entry = medium.point(points[k]), exit = medium.point(points[k + 1]);
      const double chord = glm::distance(points[k].position, points[k + 1].position);
      if (chord > 1.7) continue;  // near the other pole an arc's length is too sensitive to the chord's
      const double between =
          aggregate_albedo(albedo, body.placement, points[k], points[k + 1], chord, ek17_kernel).r;
      const double arc = 2 * std::asin(0.5 * chord);
      const double expected =
          entry.albedo.r * exit.albedo.r / between * 9 * profile.evaluate_over_albedo(between, 3 * arc);
      CAPTURE(name, chord);
      // The polyhedron is 0.03 % shorter than the ball, and S falls by at most its own logarithmic slope.
      CHECK(model->evaluate(entry, exit).r == Approx(expected).epsilon(0.012));
    }
  }
}

TEST_CASE("where there is no way over the surface the basis has the chord", "[bssrdf]") {
  // Opposite sides of a slab: no straightest path arrives.
  const Body body(make_slab(2, 0.1, 8));
  const AnalyticProfile profile;
  const CosineAlbedo albedo(Rgb(0.6));
  BssrdfMedium medium{&profile, Rgb(3), &albedo};
  const auto chord = make_bssrdf("homogeneous", medium, {});
  const auto distance = make_surface_distance("geodesic", body.parts());
  medium.distance = distance.get();
  const auto geodesic = make_bssrdf("homogeneous", medium, {});
  const auto above = body.rays.closest_point(0, {0.3, 0.05, 0.1}),
             below = body.rays.closest_point(0, {0.3, -0.05, 0.1});
  const BssrdfPoint a = medium.point(body.mesh.surface_point(above->triangle, above->barycentric));
  const BssrdfPoint b = medium.point(body.mesh.surface_point(below->triangle, below->barycentric));
  CHECK(geodesic->evaluate(a, b) == chord->evaluate(a, b));
}
