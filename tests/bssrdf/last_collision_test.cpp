#include "bssrdf/last_collision.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "bssrdf/body.h"
#include "core/rng.h"
#include "geometry/shapes.h"
#include "support/analytic_albedo.h"
#include "support/analytic_profile.h"

using namespace alabaster;

namespace {

const PlanarPlacement unit_plane{Mat2(1.0)};
const AnalyticProfile profile;

/// A point of the plane z = 0, whose UV is its position in metres, seen at an angle from +x.
BssrdfPoint seen(double x, double angle) {
  BssrdfPoint point;
  point.surface.position = {x, 0, 0};
  point.surface.geometric_normal = point.surface.shading_normal = {0, 0, 1};
  point.surface.uv = {x, 0};
  point.towards_viewer = {std::sin(angle), 0, std::cos(angle)};
  return point;
}

/// 0.5 + 0.4 cos(2 pi f x), averaged along the refracted ray from x with density exp(-s / path) / path.
double along_ray(double f, double x, double sine_inside, double path) {
  const std::complex<double> turn(0, 2 * pi * f), one = 1;
  // Seen from +x, the ray comes from -x.
  return 0.5 + 0.4 * (std::exp(turn * x) / (one + turn * (sine_inside * path))).real();
}

}  // namespace

TEST_CASE("straight down, light was last scattered right below", "[bssrdf]") {
  const CosineAlbedo waves(Rgb(0.5), Rgb(0.4));
  const BssrdfMedium medium{&profile, Rgb(1, 2, 3), &waves};
  for (const double x : {0.0, 0.1, 0.37}) {
    BssrdfPoint exit = seen(x, 0);
    exit.albedo = waves.at(exit.surface);
    const Rgb albedo = last_collision_albedo(medium, unit_plane, exit);
    CHECK((albedo.r == exit.albedo.r && albedo.g == exit.albedo.g && albedo.b == exit.albedo.b));
  }
}

TEST_CASE("seen at a slant, albedo is averaged along the refracted ray", "[bssrdf]") {
  const double angle = 0.9, sine = std::sin(angle) / profile.eta();
  const Rgb sigma_t(1, 2, 0.5);
  for (const double f : {0.002, 0.01, 0.05, 0.15}) {
    const CosineAlbedo waves(Rgb(0.5), Rgb(0.4), {f, 0});
    const BssrdfMedium medium{&profile, sigma_t, &waves};
    for (const double x : {0.0, 0.2 / f, 0.6 / f}) {
      const Rgb albedo = last_collision_albedo(medium, unit_plane, seen(x, angle));
      for (int c = 0; c < 3; ++c) {
        const double phase = 2 * pi * f * sine / sigma_t[c];
        INFO("period " << 1 / f << ", x " << x << ", channel " << c << ", phase " << phase);
        // Exact to first order in the phase; what two Gaussians leave of the second is computed by hand.
        CHECK(albedo[c] == Approx(along_ray(f, x, sine, 1 / sigma_t[c])).margin(0.4 * 0.14 * phase * phase));
      }
    }
  }
}

TEST_CASE("over all directions, albedo is averaged around the exit", "[bssrdf]") {
  // The exact mean over azimuth and flight is 1 / sqrt(1 + k^2).
  for (const double f : {0.01, 0.1, 0.3}) {
    const CosineAlbedo waves(Rgb(0.5), Rgb(0.4), {f, 0});
    const BssrdfMedium medium{&profile, Rgb(1), &waves};
    BssrdfPoint exit = seen(0.2 / f, 0);
    exit.towards_viewer = Vec3(0);
    const double k = 2 * pi * f * std::sqrt(0.478) / profile.eta();
    const double exact = 0.5 + 0.4 * std::cos(0.4 * pi) / std::sqrt(1 + k * k);
    CHECK(last_collision_albedo(medium, unit_plane, exit).g == Approx(exact).margin(0.01));
  }
}

TEST_CASE("in a thin body the ray ends half-way", "[bssrdf]") {
  const double angle = 1.2, sine = std::sin(angle) / profile.eta(), f = 0.01;
  const CosineAlbedo waves(Rgb(0.5), Rgb(0.4), {f, 0});
  const BssrdfMedium medium{&profile, Rgb(1), &waves};
  BssrdfPoint exit = seen(0.25 / f, angle);  // where the slope is steepest
  const double thick = last_collision_albedo(medium, unit_plane, exit).g;
  const double thickness = 1.2, limit = 0.5 * thickness / std::sqrt(1 - sine * sine);
  exit.shape.inverse_thickness = 1 / thickness;
  const double thin = last_collision_albedo(medium, unit_plane, exit).g;
  // Mean of s under exp(-s) up to the limit.
  const double mean = 1 - limit * std::exp(-limit) / (1 - std::exp(-limit));
  CHECK((thin - 0.5) / (thick - 0.5) == Approx(mean).epsilon(1e-3));
  exit.shape.inverse_thickness = 1e-6;
  CHECK(last_collision_albedo(medium, unit_plane, exit).g == Approx(thick).epsilon(1e-9));
}

TEST_CASE("an exit is averaged the way the view comes from, however its chart is turned", "[bssrdf]") {
  // Every triangle of a sphere has a Jacobian of its own; UV is a map of the globe, u the longitude. The
  // field is a function of u, so that the truth is one of places in space.
  const Body body(make_sphere(1, 48));
  const double path = 0.02;
  const CosineAlbedo waves(Rgb(0.5), Rgb(0.4), {3, 0});
  const BssrdfMedium medium{&profile, Rgb(1 / path), &waves};
  double slope = 0, moved = 0;
  int count = 0;
  Rng rng(4);
  for (const SurfacePoint& place : points_on(body.mesh, 3000, 5)) {
    if (std::abs(place.geometric_normal.y) > 0.7) continue;
    BssrdfPoint exit{place, waves.at(place)};
    const Vec3 side = glm::normalize(glm::cross(place.shading_normal, Vec3(rng.uniform(), 1, rng.uniform())));
    exit.towards_viewer = glm::normalize(place.shading_normal + side);
    const double sine = std::sqrt(0.5) / profile.eta();
    // Where the mean flight came from, by the map.
    const Vec2 shift = body.atlas.uv_from_surface(place.triangle, -sine * path * side);
    SurfacePoint there = place;
    there.uv += shift;
    slope += (waves.at(there).g - exit.albedo.g) *
             (last_collision_albedo(medium, body.placement, exit).g - exit.albedo.g);
    moved += (waves.at(there).g - exit.albedo.g) * (waves.at(there).g - exit.albedo.g);
    ++count;
  }
  REQUIRE(count > 1000);
  CHECK(slope / moved == Approx(1).epsilon(0.05));
}
