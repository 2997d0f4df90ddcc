#include "scene/light_sampler.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/rng.h"
#include "geometry/shapes.h"
#include "scene/scene.h"
#include "support/sphere_chi_square.h"

using namespace alabaster;

namespace {

constexpr double significance = 1e-5;

Scene emissive_sphere(const Vec3& centre, double radius) {
  Scene scene;
  scene.name = "emissive sphere";
  Material glow;
  glow.name = "glow";
  glow.emission = Rgb(2);
  scene.materials.push_back(glow);
  SceneObject object;
  object.name = "sphere";
  object.mesh = make_sphere(radius, 16);
  for (Vec3& p : object.mesh.positions) p += centre;
  scene.objects.push_back(std::move(object));
  prepare_scene(scene);
  return scene;
}

/// Samples a sampler's directions and what it says of them when found by a ray.
double p_value(const Scene& scene, const LightSampler& sampler, const Vec3& point, SphereChiSquare& test) {
  Rng choice(99);
  return test.test(
      [&](Vec2 u) -> std::optional<Vec3> {
        const auto sample = sampler.sample(point, Vec3(0), choice.uniform(), u);
        if (!sample) return std::nullopt;
        return sample->direction;
      },
      [&](const Vec3& w) {
        Ray ray;
        ray.origin = point;
        ray.direction = w;
        double pdf = sampler.pdf_environment(point, Vec3(0), w);
        if (const auto hit = scene.rays.nearest(ray)) pdf += sampler.pdf_triangle(point, Vec3(0), w, *hit);
        if (const auto disk = sampler.nearest_disk(ray)) pdf += sampler.pdf_disk(point, Vec3(0), w, *disk);
        for (std::size_t i = 0; i < sampler.cone_count(); ++i)
          if (const auto cone = sampler.cone(i, ray)) pdf += sampler.pdf_cone(point, Vec3(0), *cone);
        return pdf;
      });
}

/// Irradiance on a surface by sampling lights alone, without occlusion.
RunningMoments irradiance(const LightSampler& sampler, const Vec3& point, const Vec3& normal, int n) {
  RunningMoments result;
  Rng rng(5);
  for (int i = 0; i < n; ++i) {
    const auto sample = sampler.sample(point, normal, rng.uniform(), {rng.uniform(), rng.uniform()});
    const double cosine = sample ? std::max(0.0, glm::dot(normal, sample->direction)) : 0;
    result.add(cosine > 0 ? sample->radiance.mean() * cosine / sample->pdf : 0);
  }
  return result;
}

void check_mean(const RunningMoments& moments, double expected) {
  INFO(moments.mean() << " +- " << moments.standard_error() << ", expected " << expected);
  if (moments.standard_error() < 1e-9 * expected)
    CHECK(moments.mean() == Approx(expected).epsilon(1e-9));
  else
    CHECK(two_sided_normal_p_value((moments.mean() - expected) / moments.standard_error()) > significance);
}

}  // namespace

TEST_CASE("emissive triangles are drawn by their density") {
  const Scene scene = emissive_sphere({0, 0, 4}, 1);
  const LightSampler sampler(scene);
  SphereChiSquare test;
  test.axis = {0, 0, 1};
  test.least_cosine = 0.95;
  CHECK(p_value(scene, sampler, Vec3(0), test) > significance);
  // The back half of the sphere faces away: those samples come to nothing.
  CHECK(test.mass > 0.3);
  CHECK(test.mass < 0.5);
}

TEST_CASE("a disk is drawn by its density") {
  Scene scene;
  scene.rays.commit();
  scene.lights.push_back(DiskLight{{0, 0.5, 3}, glm::normalize(Vec3(0, -0.2, -1)), 1, Rgb(1)});
  const LightSampler sampler(scene);
  SphereChiSquare test;
  test.least_cosine = 0.8;
  test.quadrature = 40;
  CHECK(p_value(scene, sampler, Vec3(0), test) > significance);
  CHECK(test.mass == Approx(1).epsilon(3e-3));
}

TEST_CASE("a sample states the density of its direction") {
  Scene sphere = emissive_sphere({0, 0, 4}, 1);
  Scene disk;
  disk.rays.commit();
  disk.lights.push_back(DiskLight{{0, 0.5, 3}, glm::normalize(Vec3(0, -0.2, -1)), 1, Rgb(1)});
  for (const Scene* scene : {&sphere, &disk}) {
    const LightSampler sampler(*scene);
    Rng rng(4);
    int found = 0;
    for (int i = 0; i < 500; ++i) {
      const auto sample = sampler.sample(Vec3(0), Vec3(0), rng.uniform(), {rng.uniform(), rng.uniform()});
      if (!sample) continue;
      Ray ray;
      ray.direction = sample->direction;
      const auto hit = scene->rays.nearest(ray);
      const auto on_disk = sampler.nearest_disk(ray);
      if (!hit && !on_disk) continue;  // an edge of the mesh
      ++found;
      const double pdf = hit ? sampler.pdf_triangle(Vec3(0), Vec3(0), sample->direction, *hit)
                             : sampler.pdf_disk(Vec3(0), Vec3(0), sample->direction, *on_disk);
      CHECK(sample->distance == Approx(hit ? hit->t : on_disk->t).epsilon(1e-5));
      CHECK(sample->pdf == Approx(pdf).epsilon(1e-4));
    }
    CHECK(found > 100);
  }
}

TEST_CASE("several lights together are drawn by their densities") {
  Scene scene = emissive_sphere({0, 0, 4}, 1);
  scene.environment = make_sky_environment({});
  scene.lights.push_back(DiskLight{{3, 0, 1}, {-1, 0, 0}, 1.5, Rgb(2)});
  const LightSampler sampler(scene);
  SphereChiSquare test;
  test.quadrature = 30;
  test.rows = 24;
  CHECK(p_value(scene, sampler, Vec3(0), test) > significance);
}

TEST_CASE("lights of an angular size are drawn by their densities") {
  Scene scene;
  scene.rays.commit();
  scene.environment = make_sky_environment({});
  scene.lights.push_back(DirectionalLight{glm::normalize(Vec3(1, 0.3, -1)), Rgb(1)});
  scene.lights.push_back(PointLight{{0, 2, 0}, Rgb(5)});
  scene.lights.push_back(DiskLight{{3, 0, 1}, {-1, 0, 0}, 1.5, Rgb(2)});
  const LightSampler sampler(scene, 0.7);
  CHECK_FALSE(sampler.has_sizeless());
  SphereChiSquare test;
  test.quadrature = 30;
  test.rows = 24;
  CHECK(p_value(scene, sampler, Vec3(0), test) > significance);
  // Concentrated light alone: not the sky.
  Rng choice(98);
  SphereChiSquare directions = test;
  CHECK(directions.test(
            [&](Vec2 u) -> std::optional<Vec3> {
              const auto sample = sampler.sample_concentrated(Vec3(0), Vec3(0), choice.uniform(), u);
              if (!sample) return std::nullopt;
              return sample->direction;
            },
            [&](const Vec3& w) { return sampler.pdf_concentrated(Vec3(0), Vec3(0), w); }) > significance);
}

TEST_CASE("lights without size, and the same with an angular size, give the irradiance of the closed form") {
  struct Case {
    Light light;
    double angular_size, irradiance;
  };
  const Case cases[] = {
      {PointLight{{3, 0, 4}, Rgb(50)}, 0.5, 50 * 0.8 / 25},
      {SpotLight{{0, 0, 2}, {0, 0, -1}, Rgb(8), 0.3, 0.6}, 0.5, 2},
      {DirectionalLight{glm::normalize(Vec3(1, 0, -1)), Rgb(3)}, 0.02, 3 / std::sqrt(2.0)},
  };
  for (const auto& [light, angular_size, expected] : cases) {
    Scene scene;
    scene.rays.commit();
    scene.lights.push_back(light);
    check_mean(irradiance(LightSampler(scene), Vec3(0), {0, 0, 1}, 10), expected);
    check_mean(irradiance(LightSampler(scene, angular_size), Vec3(0), {0, 0, 1}, 20000), expected);
  }
}

TEST_CASE("closed forms of irradiance") {
  Scene scene;
  scene.rays.commit();
  const Vec3 up(0, 0, 1);
  SECTION("spot: full inside the inner cone, nothing outside the outer, squared between") {
    const SpotLight spot{{0, 0, 2}, {0, 0, -1}, Rgb(8), 0.3, 0.6};
    scene.lights.push_back(spot);
    const LightSampler sampler(scene);
    check_mean(irradiance(sampler, Vec3(0), up, 10), 2);
    CHECK(irradiance(sampler, {2, 0, 0}, up, 10).mean() == 0);
    const double x = 2 * std::tan(0.45), d2 = x * x + 4;
    const double t = (std::cos(0.45) - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6));
    check_mean(irradiance(sampler, {x, 0, 0}, up, 10), 8 * t * t / d2 * std::cos(0.45));
  }
  SECTION("disk overhead: pi L r^2 / (r^2 + h^2)") {
    scene.lights.push_back(DiskLight{{0, 0, 2}, {0, 0, -1}, 1.5, Rgb(4)});
    check_mean(irradiance(LightSampler(scene), Vec3(0), up, 50000), pi * 4 * 2.25 / (2.25 + 4));
    CHECK(irradiance(LightSampler(scene), {0, 0, 3}, -up, 100).mean() == 0);  // behind it
  }
  SECTION("constant sky: pi L") {
    scene.environment = make_constant_environment(Rgb(0.7));
    check_mean(irradiance(LightSampler(scene), Vec3(0), up, 50000), 0.7 * pi);
  }
  SECTION("all at once add up") {
    scene.environment = make_constant_environment(Rgb(0.7));
    scene.lights.push_back(PointLight{{3, 0, 4}, Rgb(50)});
    scene.lights.push_back(DiskLight{{0, 0, 2}, {0, 0, -1}, 1.5, Rgb(4)});
    check_mean(irradiance(LightSampler(scene), Vec3(0), up, 100000),
               0.7 * pi + 50 * 0.8 / 25 + pi * 4 * 2.25 / (2.25 + 4));
  }
}

TEST_CASE("an emissive sphere lights as pi L sin^2 of its angular radius") {
  // The mesh is inscribed, so a little smaller: its solid angle is measured with rays by the chi-square test
  // above; here a fine mesh is close enough to the sphere for one per cent.
  Scene scene;
  Material glow;
  glow.emission = Rgb(2);
  scene.materials.push_back(glow);
  SceneObject object;
  object.mesh = make_sphere(1, 96);
  for (Vec3& p : object.mesh.positions) p += Vec3(0, 0, 3);
  scene.objects.push_back(std::move(object));
  prepare_scene(scene);
  const RunningMoments e = irradiance(LightSampler(scene), Vec3(0), {0, 0, 1}, 100000);
  CHECK(e.mean() == Approx(2 * pi / 9).epsilon(0.01));
}

TEST_CASE("lights below the horizon are not chosen") {
  Scene scene;
  scene.rays.commit();
  scene.lights.push_back(PointLight{{0, 0, -1}, Rgb(1000)});
  scene.lights.push_back(PointLight{{0, 0, 1}, Rgb(1)});
  const LightSampler sampler(scene);
  Rng rng(3);
  for (int i = 0; i < 100; ++i) {
    const auto sample = sampler.sample(Vec3(0), {0, 0, 1}, rng.uniform(), {rng.uniform(), rng.uniform()});
    REQUIRE(sample.has_value());
    CHECK(sample->direction.z > 0);
    CHECK(sample->pdf == Approx(1));
    CHECK(sample->delta);
  }
  CHECK_FALSE(LightSampler(scene).sample({0, 0, -2}, {0, 0, -1}, 0.5, {0.5, 0.5}).has_value());
}

TEST_CASE("a patch gives uniform radiance within its radius and nothing outside") {
  Scene scene;
  scene.rays.commit();
  scene.lights.push_back(PatchLight{{1, 0, 0}, 0.5, Rgb(2, 3, 4)});
  scene.lights.push_back(PatchLight{{1.5, 0, 0}, 0.5, Rgb(1)});
  const LightSampler sampler(scene);
  CHECK(sampler.uniform_radiance({1, 0.4999, 0}) == Rgb(2, 3, 4));
  CHECK(sampler.uniform_radiance({1, -0.5001, 0}) == Rgb(0));
  CHECK(sampler.uniform_radiance({1.25, 0, 0}) == Rgb(3, 4, 5));
  CHECK(sampler.uniform_radiance({0, 0, 0}) == Rgb(0));
  CHECK_FALSE(sampler.has_lights());
  CHECK_FALSE(sampler.sample(Vec3(0), {0, 0, 1}, 0.5, {0.5, 0.5}).has_value());
}
