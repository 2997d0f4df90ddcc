#include <catch2/catch.hpp>

#include "integrators/render.h"
#include "integrators/scene_builder.h"
#include "support/z_test.h"

using namespace alabaster;
using namespace alabaster::test;

namespace {

Image ball_image(SamplerKind sampler, uint64_t seed) {
  Scene scene;
  add(scene, make_sphere(1, 32), medium_material(Rgb(0.95, 0.8, 0.5), Rgb(0.1, 0.05, 0.02)));
  add(scene, placed(make_sphere(0.4, 24), Vec3(0.9, 0.5, 0.9)),
      diffuse_material(Rgb(0.7, 0.4, 0.3), 0.4, 0.5));
  scene.environment = make_sky_environment({});
  scene.lights.push_back(DiskLight{Vec3(-2, 2, 2), glm::normalize(Vec3(1, -1, -1)), 0.5, Rgb(5)});
  prepare_scene(scene);
  SurfaceOptions options;
  options.width = options.height = 12;
  options.camera = parallel_camera(Vec3(0), Vec3(0.2, 0.3, 1), 5, 2.6);
  RenderOptions render_options;
  render_options.spp = 64;
  render_options.seed = seed;
  render_options.sampler = sampler;
  const RenderResult result = render(SurfaceIntegrator(scene, options), render_options);
  CHECK(result.rejected == 0);
  return result.film.develop();
}

}  // namespace

TEST_CASE("Sobol and independent samples agree (z-test over pixels), nothing negative") {
  const Image sobol = ball_image(SamplerKind::sobol, 1),
              independent = ball_image(SamplerKind::independent, 2);
  const ZTest z = z_test(sobol, independent, 15);
  INFO(z.where << ", p = " << z.smallest_p);
  CHECK(z.passes());
  for (const Image* image : {&sobol, &independent})
    for (int c = 0; c < static_cast<int>(image->channels().size()); ++c)
      for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 12; ++x) {
          REQUIRE(std::isfinite(image->at(c, x, y)));
          if (image->channels()[static_cast<std::size_t>(c)].rfind("normal.", 0) != 0)
            REQUIRE(image->at(c, x, y) >= 0);
        }
}
