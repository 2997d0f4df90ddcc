#include <catch2/catch.hpp>
#include <functional>

#include "integrators/walk_body.h"

using namespace alabaster;
using namespace alabaster::test;

// Totals of homogeneous spheres under uniform diffuse light, g = 0.3, eta = 1.5, from an independent
// simulation of 6 million photons (standard error at most 0.0002). One channel per albedo; three of the same
// sigma_t share their paths.
TEST_CASE("spheres return what an independent simulation says (z-test at 1e-4, Sidak over 3)") {
  struct Case {
    double radius;
    double expected[3];
  };
  const Rgb albedo(0.5, 0.8, 0.95);
  for (const Case& c : {Case{3, {0.0743, 0.2684, 0.6483}}, Case{10, {0.0355, 0.1339, 0.4009}}}) {
    const Body body(make_sphere(c.radius * 0.01, 192));
    const EqualAlbedo field(albedo);
    // The albedo is equal everywhere; the exit's spares the queries for the closest point.
    VolumeWalkOptions options;
    options.albedo = WalkAlbedo::exit;
    const VolumeWalk walk = walk_in(body, {Rgb(0.01), 0.3, 1.5}, field, options);
    const Returned result = returned(body, walk, 60000, 5);
    for (int k = 0; k < 3; ++k) {
      const RunningMoments& m = result.scattered[k];
      const double z = (m.mean() - c.expected[k]) / std::hypot(m.standard_error(), 0.0002);
      INFO("radius " << c.radius << " albedo " << albedo[k] << ": " << m.mean() << " +- "
                     << m.standard_error() << ", expected " << c.expected[k]);
      CHECK(two_sided_normal_p_value(z) > sidak(1e-4, 3));
    }
    CHECK(walk.counts().lost.load() == 0);
  }
}

TEST_CASE("at albedo 1 all light comes back, also with a mean free path per channel") {
  const Body body(make_torus(0.05, 0.02, 96));
  const EqualAlbedo white(Rgb(1));
  const VolumeWalk walk = walk_in(body, {Rgb(0.01, 0.005, 0.02), 0.3, 1.5}, white);
  const Returned result = returned(body, walk, 20000, 6);
  for (int c = 0; c < 3; ++c) {
    const double mean = result.scattered[c].mean() + result.unscattered[c].mean();
    const double error = result.scattered[c].standard_error() + result.unscattered[c].standard_error();
    INFO("channel " << c << ": " << mean << " +- " << error);
    CHECK(std::abs(mean - 1) < 4 * error + 1e-9);
  }
  CHECK(walk.counts().lost.load() <= 2);
}

TEST_CASE(
    "three channels of different mean free path agree with one at a time (z-test at 1e-4, Sidak over 3)") {
  const Body body(make_torus(0.05, 0.02, 96));
  const EqualAlbedo field(Rgb(0.9, 0.7, 0.95));
  const Rgb mean_free_path(0.02, 0.01, 0.005);
  const Returned together = returned(body, walk_in(body, {mean_free_path, 0.3, 1.5}, field), 10000, 7);
  for (int c = 0; c < 3; ++c) {
    const Returned alone = returned(body, walk_in(body, {Rgb(mean_free_path[c]), 0.3, 1.5}, field), 10000, 8);
    const RunningMoments &a = together.scattered[c], &b = alone.scattered[c];
    const double z = (a.mean() - b.mean()) / std::sqrt(a.variance_of_mean() + b.variance_of_mean());
    INFO("channel " << c << ": " << a.mean() << " against " << b.mean());
    CHECK(two_sided_normal_p_value(z) > sidak(1e-4, 3));
  }
}

TEST_CASE(
    "the walk with closest points and the walk with the exit's albedo agree on a constant texture (z-test at "
    "1e-4)") {
  const Body body(make_blob(0.05, 0.2, 64));
  const EqualAlbedo field(Rgb(0.9));
  VolumeWalkOptions exit;
  exit.albedo = WalkAlbedo::exit;
  const Returned a = returned(body, walk_in(body, {Rgb(0.01), 0.3, 1.5}, field), 20000, 9);
  const Returned b = returned(body, walk_in(body, {Rgb(0.01), 0.3, 1.5}, field, exit), 20000, 10);
  const double z = (a.scattered[0].mean() - b.scattered[0].mean()) /
                   std::sqrt(a.scattered[0].variance_of_mean() + b.scattered[0].variance_of_mean());
  CHECK(two_sided_normal_p_value(z) > 1e-4);
}

TEST_CASE(
    "cached closest points give what exact ones give, across edges and the medial axis (z-test at 1e-4, "
    "Sidak "
    "over 9)") {
  // Periods of half to four mean free paths; the slab's middle plane is where both faces are equally close.
  struct Case {
    TriangleMesh mesh;
    double period;
  };
  for (Case& c : std::vector<Case>{{make_blob(0.06, 0.2, 48), 0.02},
                                   {make_torus(0.05, 0.02, 48), 0.005},
                                   {make_slab(0.1, 0.02, 6), 0.04}}) {
    const Body body(std::move(c.mesh));
    const StripedAlbedo field(body.mesh, c.period);
    VolumeWalkOptions exact;
    exact.closest_point = ClosestPointMode::exact;
    const Medium medium{Rgb(0.01), 0.3, 1.5};
    const VolumeWalk cached_walk = walk_in(body, medium, field);
    const Returned a = returned(body, cached_walk, 30000, 11);
    const Returned b = returned(body, walk_in(body, medium, field, exact), 30000, 12);
    const auto& counts = cached_walk.counts();
    CHECK(counts.queries.load() < counts.collisions.load());
    for (int k = 0; k < 3; ++k) {
      const RunningMoments &m = a.scattered[k], &n = b.scattered[k];
      const double z = (m.mean() - n.mean()) / std::sqrt(m.variance_of_mean() + n.variance_of_mean());
      INFO("period " << c.period << ", channel " << k << ": " << m.mean() << " against " << n.mean() << " +- "
                     << n.standard_error());
      CHECK(two_sided_normal_p_value(z) > sidak(1e-4, 9));
      CHECK(m.standard_error() < 1.25 * n.standard_error());
    }
  }
}

TEST_CASE("cells bound the distance to the surface and do not depend on who asked first") {
  const Body body(make_blob(0.06, 0.2, 48));
  const StripedAlbedo field(body.mesh, 0.02);
  const AlbedoCells forwards(body.rays, body.mesh, 0, &field, 0.01);
  const AlbedoCells backwards(body.rays, body.mesh, 0, &field, 0.01);
  Rng rng(13);
  std::vector<Vec3> points;
  for (int i = 0; i < 2000; ++i) {
    const SurfacePoint on = body.uniform_point(rng);
    points.push_back(on.position - 0.03 * rng.uniform() * on.geometric_normal);
  }
  std::vector<AlbedoCells::View> views(points.size());
  for (std::size_t i = points.size(); i-- > 0;) views[i] = backwards.at(points[i]);
  std::size_t guessed = 0, close = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const AlbedoCells::View view = forwards.at(points[i]);
    CHECK(view.albedo == views[i].albedo);
    CHECK(view.exactness == views[i].exactness);
    const auto closest = body.rays.closest_point(0, points[i]);
    REQUIRE(closest);
    CHECK(view.clearance <= closest->distance + 1e-9);
    CHECK(view.reach >= closest->distance - 1e-9);
    if (view.exactness >= 1) continue;
    ++guessed;
    const Rgb exact = field.at(body.mesh.surface_point(closest->triangle, closest->barycentric));
    close += std::abs(view.albedo.r - exact.r) < 0.1 * exact.r ? 1 : 0;
  }
  // That guesses are good is worth time only; that they are not good at all would be a mistake.
  CHECK(guessed > points.size() / 3);
  CHECK(close > guessed * 8 / 10);
}

namespace {

/// A share of sigma_t by the position of the closest surface point.
class Density final : public AlbedoField {
 public:
  Density(const TriangleMesh& mesh, std::function<double(const Vec3&)> value)
      : mesh_(mesh), value_(std::move(value)) {}
  Rgb at(const SurfacePoint& point) const override {
    return Rgb(value_(mesh_.position(point.triangle, point.barycentric)));
  }
  Rgb filtered(const KernelFootprint&) const override { return Rgb(1); }
  Rgb max() const override { return Rgb(1); }

 private:
  const TriangleMesh& mesh_;
  std::function<double(const Vec3&)> value_;
};

VolumeWalk varying_walk(const Body& body, const Medium& medium, const AlbedoField& albedo,
                        const AlbedoField& density) {
  return VolumeWalk(body.rays, body.mesh, 0, {1}, medium, albedo, {}, nullptr, &density);
}

}  // namespace

TEST_CASE(
    "half the density of a medium twice as dense is the medium, a mean free path per channel (z-test at "
    "1e-4, "
    "Sidak over 6)") {
  const Body body(make_torus(0.05, 0.02, 48));
  const EqualAlbedo field(Rgb(0.9, 0.7, 0.95));
  const Rgb mean_free_path(0.02, 0.01, 0.005);
  const Density half(body.mesh, [](const Vec3&) { return 0.5; });
  const Returned a = returned(body, walk_in(body, {mean_free_path, 0.3, 1.5}, field), 10000, 14);
  const Returned b =
      returned(body, varying_walk(body, {0.5 * mean_free_path, 0.3, 1.5}, field, half), 10000, 15);
  for (int c = 0; c < 3; ++c) {
    INFO("channel " << c << ": " << a.scattered[c].mean() << " against " << b.scattered[c].mean());
    CHECK(two_sided_normal_p_value(z_of(a.scattered[c], b.scattered[c])) > sidak(1e-4, 6));
    CHECK(two_sided_normal_p_value(z_of(a.unscattered[c], b.unscattered[c])) > sidak(1e-4, 6));
  }
}

// Between parallel planes only the optical thickness counts: a dense upper half over a thin lower half is a
// homogeneous slab of the same total.
TEST_CASE(
    "two layers of density between planes act by their optical thickness (z-test at 1e-4, Sidak over 2)") {
  const Medium medium{Rgb(0.01), 0.3, 1.5};
  const EqualAlbedo field(Rgb(0.9));
  struct Sides {
    RunningMoments up, down;
  };
  const auto by_side = [](const Body& body, const VolumeWalk& walk, uint64_t seed) {
    Sides sides;
    Rng rng(seed);
    const double top = bounding_box(body.mesh).high.y;
    const auto above = body.rays.nearest(Ray{Vec3(0.0013, 2 * top, 0.0007), Vec3(0, -1, 0)});
    REQUIRE(above);
    const SurfacePoint start = body.mesh.surface_point(above->triangle, above->barycentric);
    for (int i = 0; i < 20000; ++i) {
      const Vec3 direction = Frame(-start.geometric_normal).to_world(sample_diffuse_entry(1.5, rng));
      const auto end = walk.walk(start, direction, rng);
      const double towards = end ? end->point.geometric_normal.y : 0;
      sides.up.add(towards > 0.5 ? end->weight.r : 0);
      sides.down.add(towards < -0.5 ? end->weight.r : 0);
    }
    return sides;
  };
  const Body two(make_slab(1, 0.04, 4)), one(make_slab(1, 0.028, 4));  // 4 and 2.8 mean free paths
  const Density layers(two.mesh, [](const Vec3& p) { return p.y > 0 ? 1 : 0.4; });
  const Sides a = by_side(two, varying_walk(two, medium, field, layers), 16);
  const Sides b = by_side(one, walk_in(one, medium, field), 17);
  INFO("up " << a.up.mean() << " against " << b.up.mean() << ", down " << a.down.mean() << " against "
             << b.down.mean());
  CHECK(a.down.mean() > 10 * a.down.standard_error());
  CHECK(two_sided_normal_p_value(z_of(a.up, b.up)) > sidak(1e-4, 2));
  CHECK(two_sided_normal_p_value(z_of(a.down, b.down)) > sidak(1e-4, 2));
}

TEST_CASE(
    "light that never scatters in a varying medium passes as a ray march says (z-test at 1e-4, Sidak over "
    "8)") {
  const Body body(make_sphere(0.05, 48));
  const EqualAlbedo black(Rgb(0));
  const Density stripes(body.mesh, [](const Vec3& p) { return 0.5 + 0.5 * std::sin(200 * p.x); });
  const VolumeWalk walk = varying_walk(body, {Rgb(0.04), 0.3, 1}, black, stripes);
  Rng rng(18);
  for (int i = 0; i < 8; ++i) {
    const SurfacePoint start = body.uniform_point(rng);
    const Vec3 direction = Frame(-start.geometric_normal).to_world(sample_diffuse_entry(1, rng));
    RunningMoments passed;
    double distance = 0;
    for (int k = 0; k < 4000; ++k) {
      const auto end = walk.walk(start, direction, rng);
      passed.add(end ? 1 : 0);
      if (end) distance = glm::length(end->point.position - start.position);
    }
    double depth = 0;
    constexpr int steps = 1000;
    for (int k = 0; k < steps; ++k) {
      const Vec3 p = start.position + (k + 0.5) / steps * distance * direction;
      const auto closest = body.rays.closest_point(0, p);
      REQUIRE(closest);
      const SurfacePoint point = body.mesh.surface_point(closest->triangle, closest->barycentric);
      depth += stripes.at(point).r * distance / steps / 0.04;
    }
    const double expected = std::exp(-depth);
    INFO("ray " << i << ": " << passed.mean() << ", marched " << expected);
    CHECK(two_sided_normal_p_value((passed.mean() - expected) / std::sqrt(expected * (1 - expected) / 4000)) >
          sidak(1e-4, 8));
  }
}
