#include "integrators/surface.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <variant>

#include "integrators/bssrdf_transport.h"
#include "integrators/scene_builder.h"
#include "optics/fresnel.h"

using namespace alabaster;
using namespace alabaster::test;

namespace {

Vec3 view(double degrees) {
  return {std::sin(degrees * pi / 180), 0, std::cos(degrees * pi / 180)};
}

// A plane so large, 40,000 mean free paths, that a part of 1e-4 of the light at most leaves beyond its edge.
Scene plane_scene(const Material& material, double size = 40) {
  Scene scene;
  add(scene, make_plane(size), material);
  return scene;
}

}  // namespace

TEST_CASE("grey furnace: an unbounded plane of medium shows F + T A") {
  // docs/theory.md: under uniform light of radiance 1 an unbounded plane shows F(cos) + T(cos) A(alpha).
  for (const double albedo : {0.5, 0.9, 0.99, 1.0}) {
    Scene scene = plane_scene(medium_material(Rgb(albedo), Rgb(0.001)));
    scene.environment = make_constant_environment(Rgb(1));
    prepare_scene(scene);
    for (const double degrees : {0.0, 60.0}) {
      SurfaceOptions options;
      options.camera = parallel_camera(Vec3(0), view(degrees), 1, 0.01);
      const double f = fresnel_dielectric(std::cos(degrees * pi / 180), 1.5);
      const double expected = f + (1 - f) * baseline_profile().reflectance(albedo);
      const Measured m = measure(scene, options, 60000);
      INFO("albedo " << albedo << ", " << degrees << " degrees: " << m.mean << " +- " << m.error
                     << ", expected " << expected);
      CHECK(std::abs(m.mean - expected) < std::max(3 * m.error, 1e-4));
      CHECK(3 * m.error < 0.005 * expected * 1.5);
      CHECK(std::abs(m.mean - expected) < 0.005 * expected);
    }
  }
}

TEST_CASE("grey furnace: a smooth diffuse surface shows F + T x base colour, exactly") {
  // The body's lobe T(cos_o) T(cos_i) / (pi c) integrates to T(cos_o): no energy is lost or made.
  for (const double colour : {0.2, 1.0}) {
    Scene scene = plane_scene(diffuse_material(Rgb(colour)));
    scene.environment = make_constant_environment(Rgb(1));
    prepare_scene(scene);
    for (const double degrees : {0.0, 70.0}) {
      SurfaceOptions options;
      options.camera = parallel_camera(Vec3(0), view(degrees), 1, 0.01);
      const double f = fresnel_dielectric(std::cos(degrees * pi / 180), 1.5);
      const Measured m = measure(scene, options, 20000);
      INFO("colour " << colour << ", " << degrees << " degrees: " << m.mean << " +- " << m.error);
      CHECK(std::abs(m.mean - (f + (1 - f) * colour)) < 4 * m.error + 1e-9);
      CHECK(m.error < 2e-3);
    }
  }
}

TEST_CASE("white furnace: a smooth metal of colour 1 is invisible") {
  Scene scene = plane_scene(diffuse_material(Rgb(1), 0, 1));
  scene.environment = make_constant_environment(Rgb(1));
  prepare_scene(scene);
  SurfaceOptions options;
  options.camera = parallel_camera(Vec3(0), view(50), 1, 0.01);
  const Measured m = measure(scene, options, 100);
  CHECK(m.mean == Approx(1).margin(1e-9));
}

TEST_CASE("a rough metal under uniform light shows its directional albedo (quadrature)") {
  for (const double roughness : {0.3, 0.7, 1.0}) {
    Scene scene = plane_scene(diffuse_material(Rgb(1), roughness, 1));
    scene.environment = make_constant_environment(Rgb(1));
    prepare_scene(scene);
    SurfaceOptions options;
    const Vec3 wo = view(40);
    options.camera = parallel_camera(Vec3(0), wo, 1, 0.01);
    // The integral of D G2 / (4 cos_o) over the hemisphere by the midpoint rule.
    const Ggx ggx{roughness * roughness};
    double expected = 0;
    const int n = 600;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double z = (i + 0.5) / n, phi = 2 * pi * (j + 0.5) / n, s = std::sqrt(1 - z * z);
        const Vec3 wi(s * std::cos(phi), s * std::sin(phi), z);
        expected += ggx.distribution(glm::normalize(wo + wi)) * ggx.masking_shadowing(wo, wi) / (4 * wo.z) *
                    2 * pi / (n * n);
      }
    const Measured m = measure(scene, options, 20000);
    INFO("roughness " << roughness << ": " << m.mean << " +- " << m.error << ", expected " << expected);
    CHECK(std::abs(m.mean - expected) < 4 * m.error + 1e-4);
  }
}

TEST_CASE("without the interface's mirror and unscattered light, only the body is left") {
  Scene scene = plane_scene(medium_material(Rgb(0.9), Rgb(0.001)));
  scene.environment = make_constant_environment(Rgb(1));
  prepare_scene(scene);
  SurfaceOptions options;
  options.camera = parallel_camera(Vec3(0), view(0), 1, 0.01);
  options.specular = false;
  const Measured m = measure(scene, options, 40000);
  CHECK(std::abs(m.mean - 0.96 * baseline_profile().reflectance(0.9)) < 4 * m.error);
}

TEST_CASE("a patch light that covers the plane is the furnace") {
  Scene scene = plane_scene(medium_material(Rgb(0.9), Rgb(0.001)));
  scene.lights.push_back(PatchLight{Vec3(0), 1000, Rgb(1)});
  prepare_scene(scene);
  SurfaceOptions options;
  options.camera = parallel_camera(Vec3(0), view(0), 1, 0.01);
  const double f = fresnel_dielectric(1, 1.5);
  const Measured m = measure(scene, options, 20000);
  CHECK(std::abs(m.mean - (f + (1 - f) * baseline_profile().reflectance(0.9))) < 4 * m.error);
}

TEST_CASE("on one albedo composite is the homogeneous model, bit for bit") {
  Scene scene = plane_scene(medium_material(Rgb(0.9, 0.8, 0.3), Rgb(0.001)), 1);
  scene.environment = make_constant_environment(Rgb(1));
  prepare_scene(scene);
  SurfaceOptions options;
  options.camera = parallel_camera(Vec3(0), view(20), 1, 0.01);
  options.model = "composite";
  const Measured composite = measure(scene, options, 500);
  options.model = "homogeneous";
  CHECK(measure(scene, options, 500).mean == composite.mean);
}

TEST_CASE("light's aim is asked on bodies only, and favours light that comes from beyond the entry") {
  const auto transport_of = [](Scene& scene) {
    scene.environment = make_constant_environment(Rgb(1));
    prepare_scene(scene);
    return BssrdfTransport(scene, 0, *scene.materials[0].medium, {1}, "composite", Basis::shape);
  };
  const auto draw = [](const BssrdfTransport& transport, const SurfacePoint& exit, auto&& check) {
    Sampler sampler(SamplerKind::independent, 3);
    for (uint32_t k = 0; k < 500; ++k) {
      sampler.start(0, 0, k);
      if (const auto entry = transport.sample(exit, glm::normalize(Vec3(0.3, 0.1, 1)), sampler, 0))
        check(*entry);
    }
  };
  Scene plane = plane_scene(medium_material(Rgb(0.9, 0.7, 0.4), Rgb(0.001)));
  const BssrdfTransport flat = transport_of(plane);
  draw(flat, plane.objects[0].mesh.surface_point(0, Vec2(0.2, 0.3)),
       [](const SubsurfaceEntry& entry) { CHECK_FALSE(entry.aim); });

  Scene ball;
  add(ball, make_sphere(0.003, 64), medium_material(Rgb(0.9, 0.7, 0.4), Rgb(0.001)));
  const BssrdfTransport curved = transport_of(ball);
  const auto top = ball.rays.closest_point(0, Vec3(0, 0, 0.003));
  const SurfacePoint exit = ball.objects[0].mesh.surface_point(top->triangle, top->barycentric);
  draw(curved, exit, [&](const SubsurfaceEntry& entry) {
    REQUIRE(entry.aim);
    const Vec3 n = entry.point.shading_normal, chord = entry.point.position - exit.position;
    const Vec3 beyond = glm::normalize(chord - glm::dot(chord, n) * n);
    const Rgb from_there = entry.aim->at(beyond), from_here = entry.aim->at(-beyond);
    for (int c = 0; c < 3; ++c) {
      CHECK(from_there[c] > from_here[c]);
      CHECK(from_here[c] > 0);
      // Less absorption means longer ways, which forget where they came from.
      if (c > 0) CHECK(from_there[c] / from_here[c] > 0.98 * from_there[c - 1] / from_here[c - 1]);
    }
  });
}

TEST_CASE("which direction is followed where light's aim has a say is a matter of noise alone") {
  // A ball under a sky, with a lamp beside it that both rays and light sampling find.
  Scene scene;
  add(scene, make_sphere(0.003, 64), medium_material(Rgb(0.8), Rgb(0.001)));
  const double quarter = pi / 2;
  const Mat3 facing_ball(Vec3(std::cos(quarter), 0, std::sin(quarter)), Vec3(0, 1, 0),
                         Vec3(-std::sin(quarter), 0, std::cos(quarter)));
  add(scene, placed(make_plane(0.006), Vec3(-0.006, 0, 0.003), facing_ball), emitter_material(Rgb(3)));
  scene.environment = make_sky_environment({Rgb(0.2), Rgb(2), 4, glm::normalize(Vec3(0.8, 0.3, 0.5))});
  prepare_scene(scene);

  const Vec3 top(0, 0, 0.003), viewer = glm::normalize(Vec3(0.6, 0.3, 1));
  SurfaceOptions options;
  options.camera = parallel_camera(top, viewer, 0.1, 1e-7);
  options.basis = Basis::shape;
  options.specular = false;
  const Measured image = measure(scene, options, 40000);

  // The same with entries that know neither light nor viewer's aim, and directions by the cosine.
  const BssrdfTransport transport(scene, 0, *scene.materials[0].medium, {1, 0}, "composite", Basis::shape);
  Ray ray;
  ray.origin = top + 0.1 * viewer;
  ray.direction = -viewer;
  const SurfacePoint exit = make_interaction(scene, ray, *scene.rays.nearest(ray, 0.5)).point;
  const auto transmission = [](double cosine) { return 1 - fresnel_dielectric(cosine, 1.5); };
  RunningMoments plain;
  Sampler sampler(SamplerKind::independent, 7);
  for (uint32_t k = 0; k < 40000; ++k) {
    sampler.start(0, 0, k);
    double value = 0;
    if (const auto entry = transport.sample(exit, viewer, sampler, 0)) {
      const Vec3 normal = entry->point.shading_normal;
      Ray out;
      out.direction = cosine_direction(normal, sampler.get_2d(Dimension::diffuse_direction));
      if (glm::dot(out.direction, entry->point.geometric_normal) > 0) {
        out.origin = entry->point.position + 1e-7 * entry->point.geometric_normal;
        out.ignore_object = entry->point.object;
        out.ignore_triangle = entry->point.triangle;
        const auto hit = scene.rays.nearest(out, 0.5);
        const Rgb radiance = hit ? scene.material(*hit).emission : scene.environment->radiance(out.direction);
        value = (entry->weight * entry->aim.value_or(LightAim()).at(out.direction) * radiance).r * pi *
                transmission(glm::dot(normal, out.direction));
      }
    }
    plain.add(value * transmission(glm::dot(viewer, exit.shading_normal)));
  }
  const double z = (image.mean - plain.mean()) / std::hypot(image.error, plain.standard_error());
  CAPTURE(image.mean, image.error, plain.mean(), plain.standard_error());
  CHECK(two_sided_normal_p_value(z) > 0.01);
  CHECK(image.error < 0.7 * plain.standard_error());
}

TEST_CASE("lamps guide entries on the shape basis, and only guide them") {
  const auto transmission = [](double cosine) { return 1 - fresnel_dielectric(cosine, 1.5); };
  const Vec3 towards = glm::normalize(Vec3(-1, 0.2, 0.7)), place = 0.008 * towards;
  for (const Light& light :
       {Light(DirectionalLight{-towards, Rgb(3)}), Light(PointLight{place, Rgb(1e-4)})}) {
    Scene scene;
    add(scene, make_sphere(0.003, 64), medium_material(Rgb(0.8), Rgb(0.001)));
    scene.lights.push_back(light);
    prepare_scene(scene);
    const Vec3 top(0, 0, 0.003), viewer = glm::normalize(Vec3(0.6, 0.3, 1));
    SurfaceOptions options;
    options.camera = parallel_camera(top, viewer, 0.1, 1e-7);
    options.basis = Basis::shape;
    options.specular = false;
    const Measured image = measure(scene, options, 20000);

    // Entries that know nothing of the light.
    const BssrdfTransport transport(scene, 0, *scene.materials[0].medium, {1}, "composite", Basis::shape);
    Ray ray;
    ray.origin = top + 0.1 * viewer;
    ray.direction = -viewer;
    const SurfacePoint exit = make_interaction(scene, ray, *scene.rays.nearest(ray, 0.5)).point;
    RunningMoments plain;
    Sampler sampler(SamplerKind::independent, 7);
    for (uint32_t k = 0; k < 20000; ++k) {
      sampler.start(0, 0, k);
      double value = 0;
      if (const auto entry = transport.sample(exit, viewer, sampler, 0)) {
        const bool far = std::holds_alternative<DirectionalLight>(light);
        const Vec3 to_lamp = far ? towards : place - entry->point.position;
        const Vec3 direction = glm::normalize(to_lamp);
        const double cosine = glm::dot(entry->point.shading_normal, direction);
        if (cosine > 0 && glm::dot(entry->point.geometric_normal, direction) > 0)
          value = (entry->weight * entry->aim.value_or(LightAim()).at(direction)).r *
                  (far ? 3 : 1e-4 / length_squared(to_lamp)) * cosine * transmission(cosine);
      }
      plain.add(value * transmission(glm::dot(viewer, exit.shading_normal)));
    }
    const double z = (image.mean - plain.mean()) / std::hypot(image.error, plain.standard_error());
    CAPTURE(light.index(), image.mean, image.error, plain.mean(), plain.standard_error());
    CHECK(two_sided_normal_p_value(z) > sidak(0.01, 2));
    CHECK(image.error < 0.7 * plain.standard_error());
  }
}
