#include <catch2/catch.hpp>
#include <cmath>

#include "integrators/scene_builder.h"
#include "optics/fresnel.h"

using namespace alabaster;
using namespace alabaster::test;

namespace {

const Vec3 up_z(0, 0, 1);

SurfaceOptions looking_down() {
  SurfaceOptions options;
  options.camera = parallel_camera(Vec3(0), up_z, 5, 0.01);
  options.specular = false;
  return options;
}

// T(cos_o) T(cos_i) / (pi c) x colour x irradiance on the plane.
double expected_diffuse(double colour, double cos_light, double irradiance_on_facing) {
  const double t_o = 1 - fresnel_dielectric(1, 1.5), t_i = 1 - fresnel_dielectric(cos_light, 1.5);
  return t_o * t_i / (pi * diffuse_transmittance(1.5)) * colour * irradiance_on_facing * cos_light;
}

Mat3 facing_down() {
  return Mat3(Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1));
}

}  // namespace

TEST_CASE("delta lights give the irradiance of their formulas") {
  Scene scene;
  add(scene, make_plane(10), diffuse_material(Rgb(0.6)));
  SECTION("point") {
    scene.lights.push_back(PointLight{Vec3(1, 0, 2), Rgb(3)});
  }
  SECTION("spot, inside its inner cone") {
    scene.lights.push_back(SpotLight{Vec3(1, 0, 2), glm::normalize(Vec3(-1, 0, -2)), Rgb(3), 0.3, 0.5});
  }
  prepare_scene(scene);
  const Measured m = measure(scene, looking_down(), 200);
  const double cosine = 2 / std::sqrt(5.0);
  CHECK(m.mean == Approx(expected_diffuse(0.6, cosine, 3.0 / 5)).epsilon(0.01));  // the pixel has a width
}

TEST_CASE("a directional light gives its irradiance") {
  Scene scene;
  add(scene, make_plane(10), diffuse_material(Rgb(0.6)));
  scene.lights.push_back(DirectionalLight{glm::normalize(Vec3(1, 0, -1)), Rgb(2)});
  prepare_scene(scene);
  CHECK(measure(scene, looking_down(), 10).mean ==
        Approx(expected_diffuse(0.6, std::sqrt(0.5), 2)).epsilon(1e-6));
}

TEST_CASE(
    "a light of one degree gives what it gives without size, with bodies and media (z-test at 1e-4, Sidak "
    "over 6)") {
  const Light lights[] = {PointLight{Vec3(1, 0, 2), Rgb(3)},
                          SpotLight{Vec3(1, 0, 2), glm::normalize(Vec3(-1, 0, -2)), Rgb(3), 0.3, 0.5},
                          DirectionalLight{glm::normalize(Vec3(1, 0, -1)), Rgb(2)}};
  for (const Light& light : lights)
    for (const bool medium : {false, true}) {
      Scene scene;
      add(scene, make_plane(10), medium ? medium_material(Rgb(0.9), Rgb(0.001)) : diffuse_material(Rgb(0.6)));
      scene.lights.push_back(light);
      prepare_scene(scene);
      SurfaceOptions sized = looking_down();
      sized.angular_size = pi / 180;
      const Measured a = measure(scene, looking_down(), 20000), b = measure(scene, sized, 20000, 0, 2);
      INFO(a.mean << " +- " << a.error << " against " << b.mean << " +- " << b.error);
      // Transmission and cosine are not linear over the cone; that is of the order of its square.
      const double excess = std::max(0.0, std::abs(a.mean - b.mean) - 1e-4 * a.mean);
      CHECK(two_sided_normal_p_value(excess / std::hypot(a.error, b.error)) > sidak(1e-4, 6));
    }
}

TEST_CASE("a tiny disk light equals a point light") {
  // A disk of radius r and radiance L facing the point has the intensity pi r^2 L.
  Scene disk, point;
  add(disk, make_plane(10), diffuse_material(Rgb(0.6)));
  add(point, make_plane(10), diffuse_material(Rgb(0.6)));
  const double r = 0.01;
  const Vec3 position(1, 0, 2);
  disk.lights.push_back(DiskLight{position, glm::normalize(-position), r, Rgb(1e4)});
  point.lights.push_back(PointLight{position, Rgb(1e4 * pi * r * r)});
  prepare_scene(disk);
  prepare_scene(point);
  const Measured a = measure(disk, looking_down(), 20000), b = measure(point, looking_down(), 20000);
  CHECK(std::abs(a.mean - b.mean) < 4 * std::hypot(a.error, b.error) + 1e-4 * b.mean);
}

TEST_CASE("an emissive square, sampled and met, agrees with its solid-angle integral") {
  // Light sampling, cosine sampling and their combination must agree; the square is close, so both matter.
  Scene scene;
  add(scene, make_plane(10), diffuse_material(Rgb(0.5)));
  add(scene, placed(make_plane(2), Vec3(0, 0, 0.5), facing_down()), emitter_material(Rgb(1)));
  prepare_scene(scene);
  SurfaceOptions options = looking_down();
  options.camera.position = Vec3(0, 0, 0.4);  // below the square
  options.depth = 0;
  const Measured m = measure(scene, options, 40000);
  // Midpoint rule over the square of T(cos) cos^2 / r^2.
  double integral = 0;
  const int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Vec3 p(-1 + 2 * (i + 0.5) / n, -1 + 2 * (j + 0.5) / n, 0.5);
      const double r2 = length_squared(p), cosine = 0.5 / std::sqrt(r2);
      integral += (1 - fresnel_dielectric(cosine, 1.5)) * cosine * cosine / r2 * 4 / (n * n);
    }
  const double expected = 0.96 / (pi * diffuse_transmittance(1.5)) * 0.5 * integral;
  INFO(m.mean << " +- " << m.error << ", expected " << expected);
  CHECK(std::abs(m.mean - expected) < 4 * m.error);
  CHECK(m.error < 0.01 * expected);
}

TEST_CASE("a second object casts a shadow, on a diffuse surface and into a medium") {
  for (const bool medium : {false, true}) {
    Scene scene;
    add(scene, make_plane(10), medium ? medium_material(Rgb(0.9), Rgb(0.001)) : diffuse_material(Rgb(0.6)));
    add(scene, placed(make_plane(1), Vec3(0.5, 0, 1)), diffuse_material(Rgb(0)));
    scene.lights.push_back(PointLight{Vec3(1, 0, 2), Rgb(3)});
    prepare_scene(scene);
    SurfaceOptions options = looking_down();
    options.camera.position = Vec3(0, 0, 0.9);
    CHECK(measure(scene, options, 500).mean < 1e-3);
    options.camera.position = Vec3(-2, 0, 0.9);
    CHECK(measure(scene, options, 500).mean > 0.004);
  }
}

TEST_CASE("bounces between objects: two facing planes are a geometric series") {
  // Two parallel unbounded diffuse planes, the lower emitting 1: with reflectance a (smooth, index-matched,
  // so that F = 0) the upper shows a + a^3 + ..., the lower 1 + a^2 + ...
  const double a = 0.5;
  Scene scene;
  Material lower = emitter_material(Rgb(1)), upper = diffuse_material(Rgb(a));
  lower.base_colour_factor = {a, a, a, 1};
  upper.ior = 1;
  add(scene, make_plane(4000), lower);
  add(scene, placed(make_plane(4000), Vec3(0, 0, 1), facing_down()), upper);
  prepare_scene(scene);
  SurfaceOptions options = looking_down();
  options.camera.position = Vec3(0, 0, 0.5);
  options.depth = 40;
  const Measured m = measure(scene, options, 20000);
  INFO(m.mean << " +- " << m.error);
  CHECK(std::abs(m.mean - 1 / (1 - a * a)) < 4 * m.error + 2e-3);
  options.depth =
      0;  // no more than what the emitter sends, and its own light that the other sends back is not there
  CHECK(measure(scene, options, 2000).mean == Approx(1).margin(1e-9));
}

TEST_CASE("clear glass: a slab of index-matched absorber attenuates by Beer and Lambert") {
  Scene scene;
  add(scene, make_slab(100, 0.5), medium_material(Rgb(0), Rgb(1, 0.5, 0.25), 1.0));
  scene.environment = make_constant_environment(Rgb(1));
  prepare_scene(scene);
  SurfaceOptions options;
  options.camera = parallel_camera(Vec3(0), Vec3(0, 1, 0), 5, 0.01);
  for (int c = 0; c < 3; ++c) {
    const Measured m = measure(scene, options, 20000, c);
    const double expected = std::exp(-0.5 * (c == 0 ? 1 : c == 1 ? 2 : 4));
    INFO("channel " << c << ": " << m.mean << " +- " << m.error << ", expected " << expected);
    CHECK(std::abs(m.mean - expected) < 4 * m.error);
  }
}

TEST_CASE("clear glass without absorption is invisible under uniform light, at any index") {
  Scene scene;
  add(scene, make_sphere(1, 64), medium_material(Rgb(0), Rgb(1e9), 1.5));
  scene.environment = make_constant_environment(Rgb(1));
  prepare_scene(scene);
  SurfaceOptions options;
  options.camera = parallel_camera(Vec3(0.3, 0.2, 0), Vec3(0, 0, 1), 5, 0.4);
  const Measured m = measure(scene, options, 20000);
  INFO(m.mean << " +- " << m.error);
  CHECK(std::abs(m.mean - 1) < 4 * m.error + 1e-6);
}
