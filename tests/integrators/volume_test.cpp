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
  const auto refusal = [](Scene& scene, std::optional<double> angular_size = std::nullopt) -> std::string {
    if (!scene.objects.front().albedo) prepare_scene(scene);
    SurfaceOptions options = volume_options({0, 0, 1});
    options.angular_size = angular_size;
    try {
      const SurfaceIntegrator integrator(scene, options);
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
  CHECK(refusal(point, 1) == "accepted");
  CHECK_THAT(refusal(point, 0), Catch::Contains("light without size") && Catch::Contains("--angular-size"));
}

TEST_CASE("media that overlap, touch or lie in one another are refused, whichever part and place it is") {
  // The message for two objects of one medium.
  const auto verdict = [](TriangleMesh first, TriangleMesh second) -> std::string {
    Scene scene;
    add(scene, std::move(first), medium_material(Rgb(0.9), Rgb(0.01)));
    add(scene, std::move(second), medium_material(Rgb(0.9), Rgb(0.01)));
    prepare_scene(scene);
    try {
      const SurfaceIntegrator integrator(scene, volume_options({0, 0, 1}));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto ball = [](double radius, Vec3 centre) { return placed(make_sphere(radius, 16), centre); };
  const auto box = [](Vec3 size, Vec3 centre) {
    TriangleMesh mesh = make_slab(1, 1, 1);
    const BoundingBox bounds = bounding_box(mesh);
    for (Vec3& p : mesh.positions) p = centre + size * ((p - bounds.low) / (bounds.high - bounds.low) - 0.5);
    return mesh;
  };
  const auto both = [](TriangleMesh a, const TriangleMesh& b) {
    a.uv_sets.clear();
    const auto shifted = [](Index3 index, std::size_t by) {
      for (uint32_t& i : index) i += static_cast<uint32_t>(by);
      return index;
    };
    for (const Index3& c : b.corners) a.corners.push_back(shifted(c, a.positions.size()));
    for (const Index3& c : b.attributes) a.attributes.push_back(shifted(c, a.normals.size()));
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
    return a;
  };
  const Catch::Matchers::StdString::ContainsMatcher overlaps = Catch::Contains("overlaps the medium of"),
                                                    touches = Catch::Contains("touches the medium of"),
                                                    lies_in = Catch::Contains("lies in the medium of");

  SECTION("crossing") {
    CHECK_THAT(verdict(ball(0.1, Vec3(0)), ball(0.1, {0.15, 0, 0})),
               Catch::Contains("object0") && Catch::Contains("overlaps the medium of object 'object1'"));
    // A needle through a plate: no vertex of either is inside the other.
    CHECK_THAT(verdict(box({0.001, 0.001, 1}, Vec3(0)), box({1, 1, 0.1}, {0.01, 0.02, 0})), overlaps);
    CHECK_THAT(verdict(box({1, 1, 0.1}, Vec3(0)), box({0.001, 0.001, 1}, {0.01, 0.02, 0})), overlaps);
    // Only the second part of the first object does.
    CHECK_THAT(verdict(both(ball(0.1, {5, 0, 0}), ball(0.1, Vec3(0))), ball(0.1, {0.15, 0, 0})), overlaps);
  }
  SECTION("touching") {
    CHECK_THAT(verdict(box(Vec3(1), Vec3(0)), box(Vec3(1), {1, 0, 0})), touches);  // a whole face
    CHECK_THAT(verdict(box(Vec3(1), Vec3(0)), box(Vec3(1), {1, 1, 1})), touches);  // a corner
    CHECK_THAT(verdict(box(Vec3(1), Vec3(0)), box(Vec3(0.5), {0.75, 0.1, 0.1})), touches);
    CHECK_THAT(verdict(ball(0.1, Vec3(0)), ball(0.1, Vec3(0))), touches);  // the same twice
    // A cross of two bars: faces lie in one plane, no vertex of either is on the other.
    CHECK_THAT(verdict(box({2, 0.4, 0.2}, Vec3(0)), box({0.4, 2, 0.2}, {0, 0, 0.2})), overlaps);
    // Two edges that cross at one place.
    TriangleMesh ridge = box(Vec3(1), Vec3(0)), other = ridge;
    for (Vec3& p : ridge.positions) p = {p.x, (p.y - p.z) * std::sqrt(0.5), (p.y + p.z) * std::sqrt(0.5)};
    for (Vec3& p : other.positions)
      p = {(p.x - p.z) * std::sqrt(0.5), p.y, (p.x + p.z) * std::sqrt(0.5) + std::sqrt(2.0)};
    CHECK(verdict(ridge, other) != "accepted");
  }
  SECTION("nested") {
    CHECK_THAT(verdict(ball(0.1, Vec3(0)), ball(0.05, Vec3(0))),
               Catch::Contains("object1") && Catch::Contains("lies in the medium of object 'object0'"));
    CHECK_THAT(verdict(ball(0.05, Vec3(0)), ball(0.1, Vec3(0))), lies_in);
    // Only the second part of the second object does.
    CHECK_THAT(verdict(ball(0.1, Vec3(0)), both(ball(0.1, {0.3, 0, 0}), ball(0.02, {0.01, 0, 0}))), lies_in);
  }
  SECTION("apart") {
    CHECK(verdict(ball(0.1, Vec3(0)), ball(0.1, {0.15, 0.15, 0})) == "accepted");
    CHECK(verdict(box(Vec3(1), Vec3(0)), box(Vec3(1), {1.0001, 0, 0})) == "accepted");
    CHECK(verdict(box({2, 0.4, 0.2}, Vec3(0)), box({0.4, 2, 0.2}, {0, 0, 0.2001})) == "accepted");
    CHECK(verdict(both(ball(0.1, {-0.3, 0, 0}), ball(0.1, {0.3, 0, 0})), ball(0.1, Vec3(0))) == "accepted");
  }
}

TEST_CASE("an open sheet over a half-space reflects what adding-doubling says (z-test at 1e-4)") {
  Scene scene;  // 400 mean free paths wide
  add(scene, make_plane(0.4), medium_material(Rgb(0.5), Rgb(0.001)));
  scene.environment = make_constant_environment(Rgb(1));
  prepare_scene(scene);
  SurfaceOptions options = volume_options({0, 0, 1});
  options.walk.open_sheets = true;
  const Measured m = measure(scene, options, 30000);
  INFO(m.mean << " +- " << m.error);
  const double excess = std::max(0.0, std::abs(m.mean - 0.06542) - 0.0002);
  CHECK(two_sided_normal_p_value(excess / m.error) > 1e-4);
  CHECK(m.error < 0.02 * m.mean);
}

namespace {

// A body under a sky, a disk and a directional light of ten degrees, from which unguided walks still find it.
Scene lit_body(double eta, const Rgb& mean_free_path) {
  Scene scene;
  add(scene, make_blob(0.03, 0.2, 32), medium_material(Rgb(0.9, 0.8, 0.95), mean_free_path, eta));
  scene.environment = make_sky_environment({});
  scene.lights.push_back(DirectionalLight{glm::normalize(Vec3(-1, -1, -0.5)), Rgb(3)});
  scene.lights.push_back(DiskLight{{0.1, 0, 0.05}, glm::normalize(Vec3(-2, 0, -1)), 0.05, Rgb(2)});
  prepare_scene(scene);
  return scene;
}

}  // namespace

TEST_CASE(
    "walks that look for light see what walks see that do not, with less noise (z-test at 1e-4, Sidak over "
    "8)") {
  for (const double eta : {1.5, 1.0})
    for (const Rgb& mean_free_path : {Rgb(0.003), Rgb(0.002, 0.004, 0.008)}) {
      const Scene scene = lit_body(eta, mean_free_path);
      for (const Transport transport : {Transport::volume, Transport::walk}) {
        SurfaceOptions guided = volume_options({0.5, 0.3, 1});
        guided.transport = transport;
        guided.specular = false;
        guided.angular_size = pi / 18;
        SurfaceOptions plain = guided;
        plain.walk.look_for_light = plain.walk.steered = false;
        const Measured a = measure(scene, guided, 10000), b = measure(scene, plain, 40000, 0, 2);
        INFO("eta " << eta << ": " << a.mean << " +- " << a.error << " against " << b.mean << " +- "
                    << b.error);
        CHECK(two_sided_normal_p_value((a.mean - b.mean) / std::hypot(a.error, b.error)) > sidak(1e-4, 8));
        CHECK(a.error < 2 * b.error);  // with a quarter of the samples
      }
    }
}

TEST_CASE("light and camera exchanged give the same: reciprocity (z-test at 1e-4)") {
  // Seen far from the edges, under light of one direction: radiance / cosine of the light is symmetric.
  const Vec3 a = glm::normalize(Vec3(0.3, 1, 0)), b = glm::normalize(Vec3(-1, 0.8, 0.4));
  const auto scattered = [](const Vec3& towards_light, const Vec3& towards_camera, uint64_t seed) {
    Scene scene;  // 100 x 100 x 20 mean free paths
    add(scene, make_slab(0.1, 0.02, 8), medium_material(Rgb(0.9), Rgb(0.001)));
    scene.lights.push_back(DirectionalLight{-towards_light, Rgb(1)});
    prepare_scene(scene);
    SurfaceOptions options = volume_options(towards_camera);
    options.specular = false;
    Measured m = measure(scene, options, 30000, 0, seed);
    m.mean /= towards_light.y, m.error /= towards_light.y;
    return m;
  };
  const Measured there = scattered(a, b, 1), back = scattered(b, a, 2);
  INFO(there.mean << " +- " << there.error << " against " << back.mean << " +- " << back.error);
  CHECK(two_sided_normal_p_value((there.mean - back.mean) / std::hypot(there.error, back.error)) > 1e-4);
  CHECK(there.error < 0.03 * there.mean);
}

TEST_CASE("the layers add up to the whole (z-test at 1e-4)") {
  const Scene scene = lit_body(1.5, Rgb(0.01));
  SurfaceOptions options = volume_options({0.5, 0.3, 1});
  const Measured whole = measure(scene, options, 20000);
  double sum = 0, variance = whole.error * whole.error;
  for (const Layer layer : {Layer::scattered, Layer::unscattered, Layer::mirror}) {
    options.layer = layer;
    const Measured part = measure(scene, options, 20000, 0, 2);
    CHECK(part.mean > 0);
    sum += part.mean;
    variance += part.error * part.error;
  }
  INFO(whole.mean << " against " << sum);
  CHECK(two_sided_normal_p_value((whole.mean - sum) / std::sqrt(variance)) > 1e-4);
}
