#include <catch2/catch.hpp>
#include <cmath>

#include "core/frame.h"
#include "core/rng.h"
#include "image/exr_file.h"
#include "scene/lights.h"
#include "support/paths.h"
#include "support/sphere_chi_square.h"

using namespace alabaster;

namespace {

// One of about twenty such tests in the suite; each may fail by chance once in 10^5 seeds.
constexpr double significance = 1e-5;

double p_value(const Environment& environment, SphereChiSquare& test) {
  return test.test(
      [&](Vec2 u) -> std::optional<Vec3> {
        const auto sample = environment.sample(u);
        if (!sample) return std::nullopt;
        return sample->direction;
      },
      [&](const Vec3& w) { return environment.pdf(w); });
}

void check_consistency(const Environment& environment, uint64_t seed) {
  Rng rng(seed);
  const int n = 20000;
  RunningMoments mean;
  for (int i = 0; i < n; ++i) {
    const auto sample = environment.sample({rng.uniform(), rng.uniform()});
    REQUIRE(sample.has_value());
    CHECK(glm::length(sample->direction) == Approx(1).epsilon(1e-9));
    REQUIRE(sample->pdf == Approx(environment.pdf(sample->direction)).epsilon(1e-6));
    const Rgb radiance = environment.radiance(sample->direction);
    REQUIRE((sample->radiance - radiance).max() == Approx(0).margin(1e-6));
    mean.add(radiance.mean() / sample->pdf / (4 * pi));
  }
  // z-test of the integral against the stated mean, unless the estimator has no variance at all.
  const double expected = environment.mean_radiance().mean();
  if (mean.standard_error() > 1e-9 * expected) {
    const double z = (mean.mean() - expected) / mean.standard_error();
    CHECK(two_sided_normal_p_value(z) > significance);
  } else {
    CHECK(mean.mean() == Approx(expected).epsilon(1e-9));
  }
}

std::vector<Rgb> spotty_texels(int width, int height) {
  std::vector<Rgb> texels(static_cast<std::size_t>(width * height), Rgb(0.05));
  texels[static_cast<std::size_t>(2 * width + 3)] = Rgb(30, 10, 5);
  texels[static_cast<std::size_t>((height - 1) * width)] = Rgb(1, 8, 2);
  for (int x = 0; x < width / 4; ++x) texels[static_cast<std::size_t>(4 * width + x)] = Rgb(0);
  return texels;
}

}  // namespace

TEST_CASE("skies are drawn by their densities") {
  SphereChiSquare test;
  SECTION("constant") {
    CHECK(p_value(*make_constant_environment(Rgb(2)), test) > significance);
  }
  SECTION("the default sky, about its own direction") {
    const SkyParameters sky;
    test.axis = glm::normalize(sky.direction);
    CHECK(p_value(*make_sky_environment(sky), test) > significance);
  }
  SECTION("a narrow coloured key, along another axis") {
    SkyParameters sky{Rgb(0.1, 0.2, 0.3), Rgb(9, 3, 1), 40, {1, 0.2, 0}};
    test.axis = {0, 1, 0};
    CHECK(p_value(*make_sky_environment(sky), test) > significance);
  }
  SECTION("a key without ambient leaves half the sphere empty") {
    CHECK(p_value(*make_sky_environment({Rgb(0), Rgb(1), 1.5, {0, 0, 1}}), test) > significance);
  }
  CHECK((test.mass == Approx(1).epsilon(2e-3)));
}

TEST_CASE("a lat-long image is drawn by its density") {
  SphereChiSquare test;
  test.axis = {0, 1, 0};
  test.quadrature = 40;
  const auto environment = make_latlong_environment(12, 8, spotty_texels(12, 8), 0.7);
  CHECK(p_value(*environment, test) > significance);
  CHECK(test.mass == Approx(1).epsilon(2e-3));
}

TEST_CASE("directions above a surface are drawn by their density, which leaves out none of them") {
  const auto check = [](const Environment& environment, const Vec3& normal) {
    SphereChiSquare test;
    test.axis = normal;
    test.quadrature = 30;
    const double p = test.test(
        [&](Vec2 u) -> std::optional<Vec3> {
          const HemisphereSample sample = environment.sample_hemisphere(normal, u);
          if (!(sample.pdf > 0)) return std::nullopt;
          REQUIRE(sample.pdf == Approx(environment.pdf_hemisphere(normal, sample.direction)).epsilon(1e-6));
          return sample.direction;
        },
        [&](const Vec3& w) { return environment.pdf_hemisphere(normal, w); });
    CHECK(p > significance);
    CHECK(test.mass == Approx(1).epsilon(3e-3));
    Rng rng(3);
    for (int i = 0; i < 100; ++i)
      CHECK(environment.pdf_hemisphere(normal, cosine_direction(normal, {rng.uniform(), rng.uniform()})) > 0);
  };
  const Vec3 key = glm::normalize(SkyParameters{}.direction), aside = Frame(key).tangent;
  check(*make_constant_environment(Rgb(2)), key);
  check(*make_sky_environment({}), key);
  check(*make_sky_environment({}), aside);
  check(*make_sky_environment({}), glm::normalize(aside - 0.5 * key));
  check(*make_sky_environment({}), -key);
  check(*make_sky_environment({Rgb(0.1, 0.2, 0.3), Rgb(9, 3, 1), 40, {1, 0.2, 0}}), {0, 1, 0});
  check(*make_sky_environment({Rgb(0), Rgb(1), 0.5, {0, 0, 1}}), glm::normalize(Vec3(1, 0, 0.3)));
  check(*make_latlong_environment(12, 8, spotty_texels(12, 8), 0.7), {0, 1, 0});
}

TEST_CASE("environment samples agree with radiance, pdf and mean") {
  check_consistency(*make_constant_environment(Rgb(1, 2, 3)), 1);
  check_consistency(*make_sky_environment({}), 2);
  check_consistency(*make_sky_environment({Rgb(0.1, 0.2, 0.3), Rgb(9, 3, 1), 40, {1, 0.2, 0}}), 3);
}

TEST_CASE("a lat-long mean is that of its bilinear lookup") {
  // The mean is over texels, the lookup bilinear: they agree up to the curvature of the sine at the poles.
  const auto environment = make_latlong_environment(64, 32, spotty_texels(64, 32), 0);
  Rng rng(7);
  RunningMoments mean;
  for (int i = 0; i < 50000; ++i) {
    const auto sample = environment->sample({rng.uniform(), rng.uniform()});
    REQUIRE(sample.has_value());
    REQUIRE(sample->pdf == Approx(environment->pdf(sample->direction)).epsilon(1e-6));
    mean.add(sample->radiance.mean() / sample->pdf / (4 * pi));
  }
  CHECK(mean.mean() == Approx(environment->mean_radiance().mean()).epsilon(0.05));
}

TEST_CASE("black environments draw nothing") {
  CHECK_FALSE(make_constant_environment(Rgb(0))->sample({0.5, 0.5}).has_value());
  CHECK_FALSE(make_sky_environment({Rgb(0), Rgb(0), 4, {0, 1, 0}})->sample({0.5, 0.5}).has_value());
  const auto black = make_latlong_environment(4, 2, std::vector<Rgb>(8), 0);
  CHECK_FALSE(black->sample({0.5, 0.5}).has_value());
  CHECK(black->pdf({0, 1, 0}) == 0);
}

TEST_CASE("lat-long images show -z in the middle, +x to the right, +y on top") {
  const int w = 64, h = 32;
  std::vector<Rgb> texels;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) texels.emplace_back(x + 0.5, y + 0.5, 1);
  const auto at = [&](const Vec3& direction, double rotation) {
    return make_latlong_environment(w, h, texels, rotation)->radiance(glm::normalize(direction));
  };
  CHECK(at({0, 0, -1}, 0).r == Approx(w / 2.0));
  CHECK(at({0, 0, -1}, 0).g == Approx(h / 2.0));
  CHECK(at({1, 0, 0}, 0).r == Approx(0.75 * w));
  CHECK(at({-1, 0, 0}, 0).r == Approx(0.25 * w));
  CHECK(at({0.001, 1, 0}, 0).g == Approx(0.5).margin(0.05));
  CHECK(at({0.001, -1, 0}, 0).g == Approx(h - 0.5).margin(0.05));
  // Turned by a quarter counter-clockwise seen from above, the middle of the image faces -x.
  CHECK(at({-1, 0, 0}, pi / 2).r == Approx(w / 2.0));
}

TEST_CASE("a lat-long EXR loads, bad texels count as black") {
  const ScratchFolder folder;
  Image image(4, 2, {"R", "G", "B"});
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) image.set_rgb(0, x, y, Rgb(1, 2, 3));
  image.at(0, 1, 1) = std::nanf("");
  image.at(1, 1, 1) = -4;
  write_exr(folder / "sky.exr", image);
  const auto environment = load_latlong_environment(folder / "sky.exr", 0, Rgb(2));
  const Rgb mean = environment->mean_radiance();
  CHECK(mean.b == Approx(6));
  CHECK(mean.r == Approx(2 * 7.0 / 8));
  CHECK(mean.g == Approx(4 * 7.0 / 8));
}
