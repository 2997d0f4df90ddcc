// The volumetric reference: the surface integrator with walks through the volume below its surfaces.

#include <catch2/catch.hpp>
#include <cmath>

#include "core/error.h"
#include "integrators/scene_builder.h"
#include "optics/fresnel.h"

using namespace alabaster;
using namespace alabaster::test;

namespace {

SurfaceOptions volume_options(const Vec3& towards_camera) {
  SurfaceOptions options;
  options.transport = Transport::volume;
  options.camera = parallel_camera(Vec3(0), towards_camera, 1, 1e-4);
  return options;
}

}  // namespace

TEST_CASE("white furnace: at albedo 1 under uniform light closed shapes are invisible") {
  // Radiance 1 everywhere: what is not mirrored comes out of the body, scattered or not.
  const Rgb mean_free_path(0.01, 0.02, 0.01);
  const auto check = [&](TriangleMesh mesh, const Vec3& towards_camera, const char* what) {
    Scene scene;
    add(scene, std::move(mesh), medium_material(Rgb(1), mean_free_path));
    scene.environment = make_constant_environment(Rgb(1));
    prepare_scene(scene);
    const Measured m = measure(scene, volume_options(towards_camera), 4000, 1);
    INFO(what << ": " << m.mean << " +- " << m.error);
    CHECK(std::abs(m.mean - 1) < 3 * m.error + 1e-9);
    CHECK(m.error < 0.02);
  };
  check(make_sphere(0.03, 96), {0.3, 0.2, 1}, "sphere");
  check(make_blob(0.03, 0.2, 48), {0.3, 0.2, 1}, "blob");
  check(placed(make_torus(0.04, 0.015, 96), {0.04, 0, 0}), {0.2, 0.1, 1}, "torus");
}

// By reciprocity the radiance straight up under uniform light of radiance 1 is the total reflectance for
// light that comes in along the normal: adding-doubling, eta 1.5, g 0.3, 32 quadrature points, the specular
// 0.04 included.
TEST_CASE(
    "a thick slab seen far from its edges reflects what adding-doubling says (z-test at 1e-4, Sidak over "
    "2)") {
  struct Case {
    double albedo, expected, tolerance;
  };
  for (const Case& c : {Case{0.5, 0.06542, 0.0002}, Case{0.9, 0.21022, 0.0003}}) {
    Scene scene;  // 200 x 200 x 40 mean free paths
    add(scene, make_slab(0.2, 0.04, 8), medium_material(Rgb(c.albedo), Rgb(0.001)));
    scene.environment = make_constant_environment(Rgb(1));
    prepare_scene(scene);
    const Measured m = measure(scene, volume_options({0, 1, 0}), 30000);
    INFO("albedo " << c.albedo << ": " << m.mean << " +- " << m.error << ", expected " << c.expected);
    const double excess = std::max(0.0, std::abs(m.mean - c.expected) - c.tolerance);
    CHECK(two_sided_normal_p_value(excess / m.error) > sidak(1e-4, 2));
    CHECK(m.error < 0.02 * c.expected);
  }
}

TEST_CASE("what a walk cannot do is refused in one line") {
  const auto refusal = [](Scene& scene) -> std::string {
    prepare_scene(scene);
    try {
      const SurfaceIntegrator integrator(scene, volume_options({0, 0, 1}));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  Scene open;
  add(open, make_plane(1), medium_material(Rgb(0.9), Rgb(0.01)));
  CHECK_THAT(refusal(open), Catch::Contains("object0") && Catch::Contains("closed mesh"));

  Scene point;
  add(point, make_sphere(0.1, 16), medium_material(Rgb(0.9), Rgb(0.01)));
  point.lights.push_back(PointLight{Vec3(1), Rgb(1)});
  CHECK_THAT(refusal(point), Catch::Contains("light without size"));
}
