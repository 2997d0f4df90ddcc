#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bssrdf/aggregate.h"
#include "bssrdf/body.h"
#include "bssrdf/composite.h"
#include "core/error.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "support/analytic_albedo.h"
#include "support/analytic_profile.h"

using namespace alabaster;

namespace {

std::unique_ptr<Bssrdf> model_on(const char* name, const BssrdfMedium& medium,
                                 const KernelPlacement& placement) {
  BssrdfOptions options;
  options.placement = &placement;
  return make_bssrdf(name, medium, options);
}

/// A point of the plane z = 0 whose UV is its position in metres.
SurfacePoint on_plane(double x, double y) {
  SurfacePoint point;
  point.position = {x, y, 0};
  point.geometric_normal = point.shading_normal = {0, 0, 1};
  point.uv = {x, y};
  return point;
}

const PlanarPlacement unit_plane{Mat2(1.0)};

double largest_difference(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a.r / b.r - 1), std::abs(a.g / b.g - 1), std::abs(a.b / b.b - 1)});
}

/// Counts what models ask for.
class CountingAlbedo final : public AlbedoField {
 public:
  explicit CountingAlbedo(const AlbedoField& field) : field_(field) {}
  Rgb at(const SurfacePoint& point) const override { return field_.at(point); }
  Rgb filtered(const KernelFootprint& footprint) const override {
    ++lookups;
    return field_.filtered(footprint);
  }
  Rgb max() const override { return field_.max(); }
  mutable int lookups = 0;

 private:
  const AlbedoField& field_;
};

class CountingProfile final : public ProfileTable {
 public:
  double g() const override { return profile_.g(); }
  double eta() const override { return profile_.eta(); }
  double reflectance(double albedo) const override { return profile_.reflectance(albedo); }
  double albedo_from_reflectance(double r) const override { return profile_.albedo_from_reflectance(r); }
  double evaluate_over_albedo(double albedo, double rho) const override {
    return profile_.evaluate_over_albedo(albedo, rho);
  }
  Rgb evaluate_over_albedo(const Rgb& albedo, double rho) const override {
    ++evaluations;
    return ProfileTable::evaluate_over_albedo(albedo, rho);
  }
  Rgb evaluate_over_albedo(const Rgb& albedo, const Rgb& rho) const override {
    ++evaluations;
    return ProfileTable::evaluate_over_albedo(albedo, rho);
  }
  double sample(double albedo, double u) const override { return profile_.sample(albedo, u); }
  double pdf(double albedo, double rho) const override { return profile_.pdf(albedo, rho); }
  mutable int evaluations = 0;

 private:
  AnalyticProfile profile_;
};

}  // namespace

TEST_CASE("on a constant texture every model is the homogeneous one", "[bssrdf]") {
  const AnalyticProfile profile;
  std::vector<TriangleMesh> meshes{make_plane(8, 4), make_sphere(2, 32), make_blob(2, 0.3, 32),
                                   make_folded_sheet(6, 1, 0.2, 16)};
  int bent = 0;
  for (const TriangleMesh& mesh : meshes) {
    const Body body(mesh);
    for (const Rgb& alpha : {Rgb(0.9), Rgb(0.3, 0.8, 0.9999), Rgb(1e-6)}) {
      const CosineAlbedo albedo(alpha);
      const BssrdfMedium medium{&profile, Rgb(1, 2, 0.5), &albedo};
      const auto homogeneous = model_on("homogeneous", medium, body.placement);
      const auto points = points_on(body.mesh, 40, 3);
      for (const char* name : all_models) {
        const auto model = model_on(name, medium, body.placement);
        double worst = 0;
        for (std::size_t k = 0; k + 1 < points.size(); ++k) {
          const BssrdfPoint entry = medium.point(points[k]), exit = medium.point(points[k + 1]);
          bent += body.placement.trust(entry.surface, exit.surface) < 1;
          worst = std::max(
              worst, largest_difference(model->evaluate(entry, exit), homogeneous->evaluate(entry, exit)));
        }
        CAPTURE(name, alpha.r);
        CHECK(worst < 1e-13);
      }
    }
  }
  CHECK(bent > 100);  // the identity holds beside the cubic too
}

TEST_CASE("over an unbounded plane S integrates to the reflectance", "[bssrdf]") {
  const AnalyticProfile profile;
  for (const Rgb& alpha : {Rgb(0.2, 0.5, 0.9), Rgb(0.99), Rgb(0.9999)}) {
    const CosineAlbedo albedo(alpha);
    const Rgb sigma_t(0.5, 3, 40);
    const BssrdfMedium medium{&profile, sigma_t, &albedo};
    for (const char* name : all_models) {
      const auto model = model_on(name, medium, unit_plane);
      const BssrdfPoint exit = medium.point(on_plane(0, 0));
      // Midpoints in the logarithm of the distance, 1e-6 m to 1e4 m.
      constexpr int steps = 4000;
      const double step = std::log(1e10) / steps;
      Rgb sum;
      for (int k = 0; k < steps; ++k) {
        const double d = 1e-6 * std::exp((k + 0.5) * step);
        sum += 2 * pi * d * d * step * model->evaluate(medium.point(on_plane(d, 0)), exit);
      }
      for (int c = 0; c < 3; ++c) CHECK(sum[c] == Approx(profile.reflectance(alpha[c])).epsilon(1e-4));
    }
  }
}

TEST_CASE("S_V scales with the scene, and no direction is special", "[bssrdf]") {
  const AnalyticProfile profile;
  const CosineAlbedo albedo(Rgb(0.6, 0.7, 0.5), Rgb(0.3, 0.2, 0.4), {2, 1});
  const Mat4 turn = glm::rotate(Mat4(1), 1.1, glm::normalize(Vec3(1, 2, 3)));
  constexpr double scale = 32;  // exact in the float coordinates that closest points come from
  TriangleMesh plain = make_blob(2, 0.3, 32), turned = plain, larger = plain;
  for (Vec3& p : turned.positions) p = Vec3(turn * Vec4(p, 1));
  for (Vec3& p : larger.positions) p *= scale;
  const Body body(plain), turned_body(turned), larger_body(larger);
  const BssrdfMedium medium{&profile, Rgb(1), &albedo};
  const BssrdfMedium thinner{&profile, Rgb(1 / scale), &albedo};
  const auto a = points_on(plain, 200, 3);
  for (const char* name : all_models) {
    const auto model = model_on(name, medium, body.placement);
    const auto turned_model = model_on(name, medium, turned_body.placement);
    const auto larger_model = model_on(name, thinner, larger_body.placement);
    double worst_turned = 0, worst_larger = 0;
    const auto same_place = [](const Body& other, const SurfacePoint& p) {
      return other.mesh.surface_point(p.triangle, p.barycentric);
    };
    for (std::size_t k = 0; k + 1 < a.size(); ++k) {
      const Rgb value = model->evaluate(medium.point(a[k]), medium.point(a[k + 1]));
      const Rgb turned_value = turned_model->evaluate(medium.point(same_place(turned_body, a[k])),
                                                      medium.point(same_place(turned_body, a[k + 1])));
      const Rgb larger_value = larger_model->evaluate(medium.point(same_place(larger_body, a[k])),
                                                      medium.point(same_place(larger_body, a[k + 1])));
      // A closest point next to an edge may go to either triangle, and the texture jumps there.
      if (body.placement.trust(a[k], a[k + 1]) == 1)
        worst_turned = std::max(worst_turned, largest_difference(turned_value, value));
      worst_larger = std::max(worst_larger, largest_difference(scale * scale * larger_value, value));
    }
    CAPTURE(name);
    CHECK(worst_turned < 1e-6);  // UV gradients are stored as float
    CHECK(worst_larger < 1e-6);
  }
}

TEST_CASE("which models are reciprocal", "[bssrdf]") {
  const AnalyticProfile profile;
  const CosineAlbedo albedo(Rgb(0.5), Rgb(0.45), {0.4, 0.1});
  const BssrdfMedium medium{&profile, Rgb(1), &albedo};
  const auto asymmetry = [&](const char* name) {
    const auto model = model_on(name, medium, unit_plane);
    double worst = 0;
    Rng rng(5);
    for (int k = 0; k < 200; ++k) {
      const BssrdfPoint a = medium.point(on_plane(4 * rng.uniform(), 4 * rng.uniform()));
      const BssrdfPoint b = medium.point(on_plane(4 * rng.uniform(), 4 * rng.uniform()));
      worst = std::max(worst, largest_difference(model->evaluate(a, b), model->evaluate(b, a)));
    }
    return worst;
  };
  CHECK(asymmetry("factorized") < 1e-12);
  CHECK(asymmetry("aggregate") < 1e-12);
  CHECK(asymmetry("composite:symmetric") < 1e-12);
  // Eq. 1's means start at the entry, and the homogeneous model looks at one end only.
  CHECK(asymmetry("composite") > 0.1);
  CHECK(asymmetry("composite:order1") > 0.1);
  CHECK(asymmetry("homogeneous") > 0.1);
}

TEST_CASE("black stays black", "[bssrdf]") {
  const AnalyticProfile profile;
  const CosineAlbedo albedo(Rgb(0, 0.4, 0.9), Rgb(0, 0.4, 0), {0.5, 0});  // g is 0 at u = 1, r everywhere
  const BssrdfMedium medium{&profile, Rgb(1), &albedo};
  const BssrdfPoint bright = medium.point(on_plane(0, 0)), dark = medium.point(on_plane(1, 0));
  REQUIRE(dark.albedo.g < 1e-15);
  for (const char* name : all_models) {
    CAPTURE(name);
    const auto model = model_on(name, medium, unit_plane);
    for (const Rgb& value : {model->evaluate(bright, dark), model->evaluate(dark, bright)}) {
      CHECK(value.is_finite());
      CHECK(value.r == 0);
      CHECK(value.b > 0);
    }
  }
  for (const char* name : {"composite", "composite:symmetric", "factorized"}) {
    const auto model = model_on(name, medium, unit_plane);
    CHECK(model->evaluate(bright, dark).g < 1e-12);
    CHECK(model->evaluate(dark, bright).g < 1e-12);
  }
}

TEST_CASE("sampling is never aimed below a hundredth of the brightest albedo", "[bssrdf]") {
  // A bright spot far away, all but black around: its light must not be overlooked.
  class Spot final : public AlbedoField {
   public:
    Rgb at(const SurfacePoint&) const override { return Rgb(1e-4); }
    Rgb filtered(const KernelFootprint&) const override { return Rgb(1e-4); }
    Rgb max() const override { return Rgb(0.9); }
  };
  const AnalyticProfile profile;
  const Spot albedo;
  const BssrdfMedium medium{&profile, Rgb(1), &albedo};
  for (const char* name :
       {"composite", "composite:symmetric", "composite:order1", "composite:view", "aggregate"})
    CHECK(model_on(name, medium, unit_plane)->typical_albedo(medium.point(on_plane(0, 0))).g ==
          Approx(0.009));
}

TEST_CASE("setting order 1 apart bounds what eq. 2 does not", "[bssrdf]") {
  // Two bright ends across dark ground: eq. 2's order 1 grows as 1 / alpha_t, a single collision cannot.
  const AnalyticProfile profile;
  double previous = 0;
  for (const double dark : {0.1, 0.01, 0.001}) {
    const CosineAlbedo ground{Rgb(dark)};
    const BssrdfMedium medium{&profile, Rgb(1), &ground};
    const BssrdfPoint entry{on_plane(0, 0), Rgb(0.9)}, exit{on_plane(1, 0), Rgb(0.9)};
    const double eq2 = model_on("composite", medium, unit_plane)->evaluate(entry, exit).g;
    const double apart = model_on("composite:order1", medium, unit_plane)->evaluate(entry, exit).g;
    CHECK(eq2 > 5 * previous);
    CHECK(apart < profile.evaluate(0.9, 1));
    previous = eq2;
  }
}

TEST_CASE("the composite costs one basis evaluation and three lookups", "[bssrdf]") {
  const CountingProfile profile;
  const CosineAlbedo waves(Rgb(0.5), Rgb(0.4));
  const CountingAlbedo albedo(waves);
  const BssrdfMedium medium{&profile, Rgb(1), &albedo};
  const BssrdfPoint entry = medium.point(on_plane(0, 0)), exit = medium.point(on_plane(0.3, 0.4));
  const auto cost = [&](const char* name) {
    const auto model = model_on(name, medium, unit_plane);
    profile.evaluations = albedo.lookups = 0;
    model->evaluate(entry, exit);
    return std::pair(profile.evaluations, albedo.lookups);
  };
  CHECK(cost("homogeneous") == std::pair(1, 0));
  CHECK(cost("factorized") == std::pair(2, 0));
  CHECK(cost("composite") == std::pair(1, 3));  // three channels in one
  CHECK(cost("composite:symmetric") == std::pair(1, 6));
  CHECK(cost("composite:view") == std::pair(1, 5));
  CHECK(cost("aggregate") == std::pair(1, 5));
}

TEST_CASE("the aggregate's taps stand for the ellipse", "[bssrdf]") {
  const AnalyticProfile profile;
  const CosineAlbedo albedo(Rgb(0.5), Rgb(0.4), {0.15, 0.08});
  const BssrdfMedium medium{&profile, Rgb(1), &albedo};
  const BssrdfPoint exit = medium.point(on_plane(0.2, 0.4));
  // Both forms see the albedo through S; compare S of the two.
  for (const double width : {0.0, 0.5, 1.0, 2.0}) {
    const AggregateBssrdf by_taps(medium, unit_plane, width, 0), by_samples(medium, unit_plane, width, 64);
    RunningMoments ratio;
    for (int k = 0; k < 200; ++k) {
      const BssrdfPoint entry = medium.point(on_plane(0.2 + std::cos(0.7 * k), 0.4 + std::sin(0.7 * k)));
      ratio.add(by_samples.evaluate(entry, exit).g / by_taps.evaluate(entry, exit).g);
    }
    CAPTURE(width);
    CHECK(ratio.mean() == Approx(1).epsilon(0.02));
  }
  CHECK_THROWS_AS(AggregateBssrdf(medium, unit_plane, -1, 0), InputError);
  CHECK_THROWS_AS(AggregateBssrdf(medium, unit_plane, 1, 65), InputError);
}

TEST_CASE("unknown models are refused by name", "[bssrdf]") {
  const AnalyticProfile profile;
  const CosineAlbedo albedo(Rgb(0.5));
  const BssrdfMedium medium{&profile, Rgb(1), &albedo};
  CHECK_THROWS_WITH(make_bssrdf("dipole", medium, {}),
                    Catch::Contains("dipole") && Catch::Contains("composite"));
}
