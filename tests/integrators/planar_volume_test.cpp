#include "integrators/planar_volume.h"

#include <catch2/catch.hpp>

#include "core/parallel.h"
#include "integrators/planar_walk_texture.h"
#include "optics/fresnel.h"
#include "support/planar_scenes.h"
#include "support/z_test.h"

using namespace alabaster;

namespace {

Image reference(const PlanarScene& scene, PlanarEstimator estimator, uint64_t paths, uint64_t seed = 1) {
  PlanarVolume volume(scene, {estimator, seed});
  volume.run(paths);
  return volume.develop();
}

double mean_of(const Image& image, const char* channel) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) sum += image.at(image.find(channel), x, y);
  return sum / (image.width() * image.height());
}

// 32 batches each: Welch's degrees of freedom are at least 31.
constexpr double degrees = 31;

void check_estimators_agree(const PlanarScene& scene, uint64_t camera_paths) {
  const Image light = reference(scene, PlanarEstimator::from_light, 100000);
  const Image lattice = reference(scene, PlanarEstimator::lattice, 2000000, 4);
  const Image camera = reference(scene, PlanarEstimator::from_camera, camera_paths, 2);
  const Image analog = reference(scene, PlanarEstimator::analog, 2 * camera_paths, 3);
  const ZTest a = z_test(light, analog, degrees), b = z_test(light, camera, degrees);
  // Against counts too small to be normal the lattice's lack of noise would show their skew.
  const ZTest l = z_test(lattice, camera, degrees), m = z_test(lattice, light, degrees);
  INFO(a.where << "; " << b.where << "; " << l.where << "; " << m.where);
  CHECK(a.passes());
  CHECK(l.passes());
  CHECK(m.passes());
  CHECK(b.passes());
  CHECK(a.mean_square < 1.7);  // 1.07 expected; channels of grey scenes are one test
  CHECK(b.mean_square < 1.7);
  CHECK(l.mean_square < 1.7);
  CHECK(m.mean_square < 1.7);
}

}  // namespace

TEST_CASE("exact scoring, camera paths and the analog oracle agree (z-test per pixel, Sidak 1e-3)") {
  SECTION("coloured texture, straight down") {
    check_estimators_agree(coloured_planar_scene(), 200000);
  }
  SECTION("stripes seen at 50 degrees along a skewed azimuth, square light") {
    PlanarScene scene = striped_planar_scene(0.95, 0.5);
    scene.view.towards = glm::normalize(Vec3(1.1, 0.4, 1));
    scene.light.shape = PlanarLight::Shape::square;
    check_estimators_agree(scene, 200000);
  }
  SECTION("radiosity, other g and eta, mean free path by channel") {
    PlanarScene scene = coloured_planar_scene();
    scene.view.radiosity = true;
    scene.medium = {Rgb(1, 0.5, 0.8), -0.4, 1.3};
    check_estimators_agree(scene, 300000);
  }
}

TEST_CASE("the lattice of photons serves any ratio of texels to pixels") {
  PlanarScene scene = coloured_planar_scene();
  const auto check_lattice = [&] {
    const ZTest z = z_test(reference(scene, PlanarEstimator::lattice, 2000000),
                           reference(scene, PlanarEstimator::from_light, 200000, 2), degrees);
    INFO(z.where);
    CHECK(z.passes());
    CHECK(z.mean_square < 1.7);
  };
  SECTION("pixels of two and a bit texels, fewer upright") {
    scene.view.width = 7;
    scene.view.height = 5;
    check_lattice();
  }
  SECTION("texels of several pixels") {
    scene = small_planar_scene(3, [](int x, int y) { return Rgb(x == y ? 0.95 : 0.3); });
    check_lattice();
  }
  SECTION("a tile smaller than a pixel, a view off the light's centre") {
    scene.tile = Vec2(0.4, 0.3);
    scene.light.centre = Vec2(0.7, -0.3);
    scene.view.centre = Vec2(-0.2, 0.1);
    check_lattice();
  }
}

TEST_CASE("a lit plane seen straight down returns what adding-doubling says") {
  // Total reflectance at normal incidence, 32 quadrature points, eta 1.5, g 0.3, less the 0.04 specular part:
  // by reciprocity the radiance under uniform light of radiance 1.
  struct Case {
    double albedo, total, tolerance;
  };
  for (const Case& c :
       {Case{0.5, 0.06542, 0.0002}, Case{0.9, 0.21022, 0.0003}, Case{0.99, 0.55072, 0.0006}}) {
    PlanarScene scene = constant_planar_scene(c.albedo);
    scene.light.shape = PlanarLight::Shape::plane;
    scene.view.width = scene.view.height = 1;
    const Image image = reference(scene, PlanarEstimator::from_camera, 100000);
    const double error = std::sqrt(static_cast<double>(image.at(image.find("variance.G"), 0, 0)));
    INFO("albedo " << c.albedo);
    CHECK(std::abs(image.at(1, 0, 0) - (c.total - 0.04)) < c.tolerance + 3 * error);
  }
}

TEST_CASE("under light everywhere radiance, averaged over directions, is radiosity") {
  // E[L(cos) cos] over the hemisphere against the radiosity estimator, both from the camera, albedo 0.9.
  PlanarScene scene = constant_planar_scene(0.9);
  scene.light.shape = PlanarLight::Shape::plane;
  scene.view.width = scene.view.height = 1;
  double sum = 0, variance = 0;
  const int steps = 16;  // midpoint rule in cos^2
  for (int i = 0; i < steps; ++i) {
    const double cosine = std::sqrt((i + 0.5) / steps);
    scene.view.towards = Vec3(std::sqrt(1 - cosine * cosine), 0, cosine);
    const Image image = reference(scene, PlanarEstimator::from_camera, 20000, static_cast<uint64_t>(i));
    sum += image.at(0, 0, 0) / steps;
    variance += image.at(image.find("variance.R"), 0, 0) / (steps * steps);
  }
  scene.view.radiosity = true;
  const Image image = reference(scene, PlanarEstimator::from_camera, 200000, 99);
  variance += image.at(image.find("variance.R"), 0, 0);
  const double quadrature = 2e-4;  // grazing transmittance has a steep end
  CHECK(std::abs(sum - image.at(0, 0, 0)) < quadrature + 3.3 * std::sqrt(variance));
}

TEST_CASE("what left and what a fully scattering half-space keeps") {
  PlanarScene scene = constant_planar_scene(0);
  const Image black = reference(scene, PlanarEstimator::from_light, 10000);
  CHECK(mean_of(black, "R") == 0);
  // A view that holds nearly all light: radiosity x area / (c x light area) is A(alpha), which grows
  // towards 1.
  scene = constant_planar_scene(0.9999);
  scene.view.radiosity = true;
  scene.view.size = Vec2(400);
  const Image image = reference(scene, PlanarEstimator::from_light, 4000);
  const double total = mean_of(image, "R") * 400 * 400 / (diffuse_transmittance(1.5) * scene.light.area());
  // A(0.9999) = 0.93 (docs/theory.md); a few per cent leave farther than 200 mean free paths.
  CHECK(total > 0.89);
  CHECK(total < 0.95);
}

TEST_CASE("a reference image does not depend on threads or on how it is cut into runs") {
  const PlanarScene scene = coloured_planar_scene();
  set_thread_count(1);
  const Image one = reference(scene, PlanarEstimator::from_light, 6400);
  set_thread_count(3);
  PlanarVolume volume(scene, {PlanarEstimator::from_light, 1});
  volume.run(3200);
  volume.run(3200);
  set_thread_count(0);
  const Image two = volume.develop();
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      for (int c = 0; c < 7; ++c) REQUIRE(one.at(c, x, y) == two.at(c, x, y));
}

TEST_CASE("scaled together, texture, light, view and mean free path leave the image as it is") {
  PlanarScene scene = coloured_planar_scene();
  const Image metres = reference(scene, PlanarEstimator::from_light, 20000);
  scene.tile *= 0.125;
  scene.view.size *= 0.125;
  scene.light.radius *= 0.125;
  scene.medium.mean_free_path *= 0.125;
  const Image small = reference(scene, PlanarEstimator::from_light, 20000);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) CHECK(small.at(0, x, y) == Approx(metres.at(0, x, y)).epsilon(1e-5));
}

TEST_CASE("more paths bring the noise down to what was asked") {
  PlanarVolume volume(striped_planar_scene(0.95, 0.5), {});
  run_to_noise(volume, 0.01, 100000000);
  CHECK(volume.noise() <= 0.01);
  CHECK(volume.paths() < 2000000);
}

TEST_CASE("scenes that make no sense are refused by name") {
  PlanarScene scene = constant_planar_scene(0.5);
  scene.light.shape = PlanarLight::Shape::plane;
  CHECK_THROWS_WITH(PlanarVolume(scene, {}), Catch::Contains("'test'") && Catch::Contains("camera"));
  scene = constant_planar_scene(1.5);
  CHECK_THROWS_WITH(PlanarVolume(scene, {}), Catch::Contains("albedo"));
  scene = constant_planar_scene(0.5);
  scene.view.towards = Vec3(0, 0, -1);
  CHECK_THROWS_WITH(PlanarVolume(scene, {}), Catch::Contains("below"));
  scene = constant_planar_scene(0.5);
  scene.albedo = nullptr;
  CHECK_THROWS_WITH(PlanarVolume(scene, {}), Catch::Contains("texture"));
}
