
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "bssrdf/basis.h"
#include "bssrdf/body.h"
#include "core/rng.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "optics/light_aim.h"
#include "support/analytic_albedo.h"
#include "support/analytic_profile.h"
#include "support/mesh_integral.h"

using namespace alabaster;

namespace {

struct Shape {
  const char* name;
  TriangleMesh mesh;
  Basis basis = Basis::half_space;
};

std::vector<Shape> shapes() {
  std::vector<Shape> list;
  list.push_back({"plane", make_plane(30, 12)});
  list.push_back({"sphere of radius 3", make_sphere(3, 24)});
  list.push_back({"folded sheet", make_folded_sheet(8, 1.5, 0.2, 16)});
  list.push_back({"sphere of radius 40", make_sphere(40, 16)});  // its far side lies beyond the near part
  list.push_back({"large plane", make_plane(300, 12)});          // the area strategy alone reaches most of it
  // Light that crosses the body is probed for.
  list.push_back({"sphere of radius 3 with its shape", make_sphere(3, 24), Basis::shape});
  list.push_back({"slab of 2 with its shape", make_slab(9, 2, 6), Basis::shape});
  return list;
}

}  // namespace

TEST_CASE("entries are as dense as density() states, triangle by triangle", "[bssrdf]") {
  const AnalyticProfile profile;
  // Colours and mean free paths differ, so every component of the radius is in play.
  const CosineAlbedo albedo(Rgb(0.95, 0.7, 0.3));
  constexpr int count = 30000;
  for (const Shape& shape : shapes()) {
    Body body(shape.mesh);
    const BssrdfMedium medium{&profile, Rgb(0.7, 1, 2), &albedo,
                              shape.basis == Basis::shape ? body.shape() : nullptr};
    const auto model = make_bssrdf("homogeneous", medium, {});
    const ProbeSampler sampler(*model, body.target());
    for (const SurfacePoint& point : points_on(body.mesh, 2, 5)) {
      const auto exit = sampler.prepare(medium.point(point));
      REQUIRE(exit);
      std::vector<double> sum(body.mesh.triangle_count());
      std::array<EntrySample, 32> entries;
      Rng rng(11);
      for (int i = 0; i < count; ++i) {
        const std::size_t found = sampler.sample_entries(exit->point, entry_random(rng), entries);
        REQUIRE(found < entries.size());
        for (std::size_t k = 0; k < found; ++k) sum[entries[k].point.surface.triangle] += 1;
      }
      const auto density = [&](uint32_t triangle, Vec2 barycentric) {
        return sampler.density(*exit, body.mesh.surface_point(triangle, barycentric));
      };
      const TriangleIntegral integral(body.mesh, density, 1e-6);
      // Counts of one triangle are binomial (a line meets a triangle once); those of two may be correlated,
      // so every triangle gets a z-test of its own, and those that expect little one together.
      double worst = 0, statistic = 0, rest_expected = 0, rest_observed = 0;
      int tested = 1;
      for (uint32_t t = 0; t < sum.size(); ++t) {
        const double p = integral.over(t);
        if (p * count < 10) {
          rest_expected += p * count;
          rest_observed += sum[t];
          continue;
        }
        const double z = (sum[t] - p * count) / std::sqrt(count * p * (1 - p));
        worst = std::max(worst, std::abs(z));
        statistic += z * z;
        ++tested;
      }
      // Where a draw may find two of them the variance is at most twice the mean.
      const double rest_variance = (std::string_view(shape.name).ends_with("plane") ? 1 : 2) * rest_expected;
      if (rest_expected > 10)
        worst = std::max(worst, std::abs(rest_observed - rest_expected) / std::sqrt(rest_variance));
      CAPTURE(shape.name, worst, tested, statistic, rest_expected, rest_observed);
      CHECK(two_sided_normal_p_value(worst) > sidak(0.01, 14.0 * tested));
      // On the plane a draw has at most one entry, so the counts are multinomial.
      if (std::string_view(shape.name) == "plane")
        CHECK(chi_square_p_value(statistic, tested - 1) > sidak(0.01, 2));
    }
  }
}

TEST_CASE("one entry, and all entries, are unbiased for the integral over the surface", "[bssrdf]") {
  const AnalyticProfile profile;
  struct Case {
    const char* name;
    TriangleMesh mesh;
    Rgb mean, amplitude;
    Basis basis = Basis::half_space;
  };
  std::vector<Case> cases;
  cases.push_back({"sphere", make_sphere(2, 20), Rgb(0.7, 0.9, 0.5), Rgb(0.25, 0.09, 0.2)});
  cases.push_back(
      {"sphere with its shape", make_sphere(2, 20), Rgb(0.7, 0.9, 0.5), Rgb(0.25, 0.09, 0.2), Basis::shape});
  cases.push_back(
      {"slab of 2 with its shape", make_slab(9, 2, 6), Rgb(0.5, 0.9, 0.99), Rgb(0), Basis::shape});
  cases.push_back({"torus with its shape", make_torus(3, 1, 24), Rgb(0.5, 0.9, 0.99), Rgb(0), Basis::shape});
  cases.push_back({"folded sheet", make_folded_sheet(6, 1.2, 0.2, 10), Rgb(0.8), Rgb(0.18)});
  cases.push_back({"sphere of 1 at 0.999", make_sphere(1, 20), Rgb(0.999), Rgb(0)});
  cases.push_back({"slab of 1 at 0.999", make_slab(12, 1, 6), Rgb(0.999), Rgb(0)});
  const int tests = 2 * static_cast<int>(cases.size() * std::size(all_models));
  for (const Case& c : cases) {
    Body body(c.mesh);
    const CosineAlbedo albedo(c.mean, c.amplitude, {2, 1});
    const BssrdfMedium medium{&profile, Rgb(1, 1.5, 0.8), &albedo,
                              c.basis == Basis::shape ? body.shape() : nullptr};
    BssrdfOptions options;
    options.placement = &body.placement;
    for (const char* name : all_models) {
      if (c.basis == Basis::shape && std::string_view(name).find(':') != std::string_view::npos) continue;
      const auto model = make_bssrdf(name, medium, options);
      BssrdfPoint exit = medium.point(points_on(body.mesh, 1, 3).front());
      exit.towards_viewer = glm::normalize(Vec3(-2, 1, 1));  // guides, as the light is: it must not matter
      const auto irradiance = [](const Vec3& p) { return 1 + 0.5 * std::sin(p.x + 2 * p.y) * std::cos(p.z); };
      const auto integrand = [&](uint32_t triangle, Vec2 barycentric) {
        const SurfacePoint entry = body.mesh.surface_point(triangle, barycentric);
        return irradiance(entry.position) * model->evaluate(medium.point(entry), exit).mean();
      };
      const double exact = TriangleIntegral(body.mesh, integrand, 2e-6).over_all();

      const ExpectedLight light(std::array{ExpectedLight::Distant{glm::normalize(Vec3(1, 2, 3)), 1}});
      ProbeTarget target = body.target();
      target.light = &light;
      const ProbeSampler sampler(*model, target);
      RunningMoments one, all;
      Rng rng(17);
      std::array<EntrySample, 2> entries;  // few, so that picking among more is tested as well
      for (int i = 0; i < 8000; ++i) {
        const auto entry = sampler.sample_entry(exit, entry_random(rng));
        one.add(entry ? entry->weight.mean() * irradiance(entry->point.surface.position) : 0);
        const std::size_t count = sampler.sample_entries(exit, entry_random(rng), entries);
        double sum = 0;
        for (std::size_t k = 0; k < count; ++k)
          sum += entries[k].weight.mean() * irradiance(entries[k].point.surface.position);
        all.add(sum);
      }
      CAPTURE(c.name, name, exact, one.mean(), one.standard_error(), all.mean(), all.standard_error());
      CHECK(two_sided_normal_p_value((one.mean() - exact) / one.standard_error()) > sidak(0.01, tests));
      CHECK(two_sided_normal_p_value((all.mean() - exact) / all.standard_error()) > sidak(0.01, tests));
    }
  }
}

TEST_CASE("a choice of entries that knows viewer and light takes most of the noise of light's aim away",
          "[bssrdf]") {
  // A ball lit from the left and seen from the right: entries on the left have little of their light aimed at
  // the exit and little of that at the viewer, entries on the right much of both.
  Body body(make_sphere(5, 40));
  const AnalyticProfile profile;
  const CosineAlbedo albedo(Rgb(0.9), Rgb(0));
  const auto model = make_bssrdf("homogeneous", {&profile, Rgb(1), &albedo, body.shape()}, {});
  const Vec3 towards_light = glm::normalize(Vec3(-1, 0, 1)), viewer = glm::normalize(Vec3(1, 0, 1));
  const ExpectedLight light(std::array{ExpectedLight::Distant{towards_light, 1}});
  ProbeTarget target = body.target();
  target.light = &light;
  const ProbeSampler sampler(*model, target);
  const auto top = body.rays.closest_point(0, Vec3(0, 0, 5));
  const BssrdfPoint exit = model->medium().point(body.mesh.surface_point(top->triangle, top->barycentric));
  const auto worth = [&](const EntrySample& entry) {
    const Vec3 n = entry.point.surface.shading_normal;
    const LightAim aim(model->aim(entry.point, exit), entry.point.surface.position, n, exit.surface.position,
                       exit.surface.shading_normal, viewer);
    return entry.weight.mean() * std::max(0.0, glm::dot(n, towards_light)) * aim.at(towards_light).mean();
  };
  Rng rng(29);
  const auto variances = [&](const Vec3& seen_from) {
    BssrdfPoint known = exit;
    known.towards_viewer = seen_from;
    RunningMoments of_batches;
    for (int batch = 0; batch < 40; ++batch) {
      RunningMoments moments;
      for (int i = 0; i < 500; ++i) {
        const auto entry = sampler.sample_entry(known, entry_random(rng));
        moments.add(entry ? worth(*entry) : 0);
      }
      of_batches.add(moments.variance());
    }
    return of_batches;
  };
  const RunningMoments ignorant = variances(Vec3(0)), knowing = variances(viewer),
                       misled = variances(-viewer);
  const auto exceeds = [](const RunningMoments& a, double factor, const RunningMoments& b) {
    return (a.mean() - factor * b.mean()) / std::hypot(a.standard_error(), factor * b.standard_error());
  };
  CAPTURE(ignorant.mean(), knowing.mean(), misled.mean());
  CHECK(exceeds(ignorant, 3, knowing) > 3);
  CHECK(exceeds(misled, 1, knowing) > 3);
}
