#include "integrators/planar.h"

#include <catch2/catch.hpp>

#include "integrators/planar_volume.h"
#include "integrators/planar_walk_texture.h"
#include "integrators/render.h"
#include "optics/fresnel.h"
#include "support/planar_scenes.h"
#include "support/z_test.h"

using namespace alabaster;

namespace {

const std::vector<std::string> all_models{"homogeneous",   "factorized",          "aggregate",
                                          "composite",     "composite:symmetric", "composite:order1",
                                          "composite:view"};

Image image_of(const PlanarScene& scene, const std::string& model, PlanarSampling sampling, uint32_t spp,
               uint64_t seed = 1, SamplerKind sampler = SamplerKind::sobol) {
  const PlanarModel planar(scene, model, baseline_profile());
  RenderOptions options;
  options.spp = spp;
  options.seed = seed;
  options.sampler = sampler;
  return render(PlanarIntegrator(planar, sampling), options).film.develop();
}

double total(const Image& image, int channel) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) sum += image.at(channel, x, y);
  return sum;
}

PlanarScene quarter_turn(const PlanarScene& scene) {
  const TexelArray& from = *scene.albedo;
  auto to = std::make_shared<TexelArray>(from);
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x) to->at(from.height - 1 - y, x) = from.at(x, y);
  PlanarScene turned = scene;
  turned.albedo = to;
  return turned;
}

}  // namespace

TEST_CASE(
    "under light everywhere a constant plane shows T A, straight down and obliquely, and c A as radiosity") {
  for (const double albedo : {0.5, 0.9, 0.99}) {
    PlanarScene scene = constant_planar_scene(albedo);
    scene.light.shape = PlanarLight::Shape::plane;
    scene.view.width = scene.view.height = 2;
    const double a = baseline_profile().reflectance(albedo);
    const auto check_radiance = [&](double factor) {
      const Image image = image_of(scene, "homogeneous", PlanarSampling::profile, 1024);
      const double error = std::sqrt(total(image, image.find("variance.G"))) / 4;
      INFO("albedo " << albedo << " factor " << factor);
      CHECK(total(image, 1) / 4 == Approx(factor * a).epsilon(0.005).margin(3 * error));
    };
    check_radiance(0.96);
    scene.view.towards = glm::normalize(Vec3(1, 1, 0.7));
    check_radiance(1 - fresnel_dielectric(scene.view.towards.z, 1.5));
    scene.view.radiosity = true;
    check_radiance(diffuse_transmittance(1.5));
  }
}

TEST_CASE("on a constant texture the radiosity of the homogeneous model is the reference's") {
  PlanarScene scene = constant_planar_scene(0.9);
  scene.view.radiosity = true;
  PlanarVolume volume(scene, {});
  volume.run(400000);
  const Image model = image_of(scene, "homogeneous", PlanarSampling::clipped, 1024);
  // The table's own error is a few per mille; the total bounds it more tightly than any pixel.
  const Image truth = volume.develop();
  CHECK(total(model, 0) == Approx(total(truth, 0)).epsilon(0.01));
  for (int y = 2; y < 6; ++y)
    for (int x = 2; x < 6; ++x)
      CHECK(model.at(0, x, y) ==
            Approx(truth.at(0, x, y)).epsilon(0.02).margin(4 * std::sqrt(truth.at(4, x, y))));
}

TEST_CASE("on a constant texture every model is the homogeneous one") {
  const PlanarScene scene = constant_planar_scene(0.9);
  const Image expected = image_of(scene, "homogeneous", PlanarSampling::uniform, 16);
  for (const std::string& model : all_models) {
    const Image image = image_of(scene, model, PlanarSampling::uniform, 16);
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) {
        INFO(model);
        CHECK(image.at(0, x, y) == Approx(expected.at(0, x, y)).epsilon(1e-5));
      }
  }
}

TEST_CASE("every way of sampling converges to one image (z-test per pixel, Sidak 1e-3)") {
  // S ~ 1/d: uniform samples within the light have no finite variance, so the comparison stays with those
  // that have, and the uniform ones are compared under a light that no pixel touches.
  PlanarScene scene = coloured_planar_scene();
  const auto all = [&](const std::string& model, PlanarSampling a, PlanarSampling b) {
    const ZTest z = z_test(image_of(scene, model, a, 1024, 1, SamplerKind::independent),
                           image_of(scene, model, b, 1024, 2, SamplerKind::independent), 1023);
    INFO(model << " " << z.where);
    CHECK(z.passes());
  };
  for (const std::string& model : all_models) all(model, PlanarSampling::mis, PlanarSampling::clipped);
  all("composite", PlanarSampling::profile, PlanarSampling::clipped);
  scene.light.shape = PlanarLight::Shape::square;
  all("composite", PlanarSampling::mis, PlanarSampling::clipped);
  scene.light.centre = Vec2(4.5, 1);  // outside the view
  all("composite", PlanarSampling::uniform, PlanarSampling::clipped);
  all("homogeneous", PlanarSampling::uniform, PlanarSampling::mis);
}

TEST_CASE("scaled together, texture, light, view and mean free path leave a model's image as it is") {
  PlanarScene scene = coloured_planar_scene();
  const Image metres = image_of(scene, "composite", PlanarSampling::clipped, 16);
  scene.tile *= 0.125;
  scene.view.size *= 0.125;
  scene.light.radius *= 0.125;
  scene.medium.mean_free_path *= 0.125;
  const Image small = image_of(scene, "composite", PlanarSampling::clipped, 16);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) CHECK(small.at(0, x, y) == Approx(metres.at(0, x, y)).epsilon(1e-5));
}

TEST_CASE("a turned texture turns the image (z-test per pixel, Sidak 1e-3)") {
  const PlanarScene scene = coloured_planar_scene();
  for (const std::string& model : all_models) {
    const Image straight = image_of(scene, model, PlanarSampling::clipped, 256, 1, SamplerKind::independent);
    Image turned =
        image_of(quarter_turn(scene), model, PlanarSampling::clipped, 256, 2, SamplerKind::independent);
    Image back(8, 8, straight.channels());
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x)
        for (int c = 0; c < static_cast<int>(straight.channels().size()); ++c)
          back.at(c, x, y) = turned.at(c, 7 - y, x);
    const ZTest z = z_test(straight, back, 255);
    INFO(model << " " << z.where);
    CHECK(z.passes());
  }
}

TEST_CASE("extreme albedos, mean free paths by channel and oblong texels stay finite, black stays black") {
  for (const std::string& model : all_models) {
    PlanarScene scene =
        small_planar_scene(4, [](int x, int) { return x < 2 ? Rgb(0) : Rgb(0.9999, 1, 0.5); });
    scene.medium.mean_free_path = Rgb(1, 0.5, 2);
    scene.tile = Vec2(4, 3);
    for (const PlanarSampling sampling :
         {PlanarSampling::uniform, PlanarSampling::mis, PlanarSampling::clipped}) {
      const Image image = image_of(scene, model, sampling, 16);
      for (int c = 0; c < 3; ++c) {
        INFO(model);
        CHECK(std::isfinite(total(image, c)));
        CHECK(total(image, c) > 0);
      }
    }
    CHECK(total(image_of(constant_planar_scene(0), model, PlanarSampling::clipped, 4), 0) == 0);
  }
}

TEST_CASE("reference and models read the same albedo") {
  for (const Vec2 tile : {Vec2(4), Vec2(3, 5)}) {
    PlanarScene scene = coloured_planar_scene();
    scene.tile = tile;
    const PlanarModel model(scene, "homogeneous", baseline_profile());
    const WalkTexture<3> walk(scene, 0, 1.0);
    Rng rng(5);
    for (int i = 0; i < 1000; ++i) {
      const Vec2 p(20 * rng.uniform() - 10, 20 * rng.uniform() - 10);
      const Rgb albedo = model.point(p).albedo;
      const auto walked = walk.at(p.x, p.y);
      for (int c = 0; c < 3; ++c)
        REQUIRE(albedo[c] == Approx(walked[static_cast<std::size_t>(c)]).epsilon(1e-6).margin(1e-7));
    }
  }
}
