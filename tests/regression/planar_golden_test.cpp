// Golden images of the planar models: what later work must not change unknowingly. After a change that is
// meant, write them anew with
//   ALABASTER_WRITE_GOLDENS=1 build/release/tests/test_regression "planar images are their golden ones"
// from a release build with g++ 12, and say in the commit why they changed and by how much.

#include <catch2/catch.hpp>
#include <cstdlib>

#include "core/parallel.h"
#include "image/exr_file.h"
#include "integrators/planar.h"
#include "integrators/render.h"
#include "support/paths.h"
#include "support/planar_scenes.h"
#include "support/z_test.h"

using namespace alabaster;

namespace {

struct Golden {
  std::string file, model;
  PlanarSampling sampling;
};

const std::vector<Golden> goldens{
    {"homogeneous", "homogeneous", PlanarSampling::clipped},
    {"factorized", "factorized", PlanarSampling::clipped},
    {"aggregate", "aggregate", PlanarSampling::clipped},
    {"composite", "composite", PlanarSampling::clipped},
    {"composite-symmetric", "composite:symmetric", PlanarSampling::clipped},
    {"composite-order1", "composite:order1", PlanarSampling::clipped},
    {"composite-uniform", "composite", PlanarSampling::uniform},
    {"composite-mis", "composite", PlanarSampling::mis},
};

constexpr uint32_t spp = 64;

Image render_golden(const Golden& golden) {
  PlanarScene scene = coloured_planar_scene();
  scene.view.width = scene.view.height = 16;
  const PlanarModel model(scene, golden.model, baseline_profile());
  RenderOptions options;
  options.spp = spp;
  options.seed = 2017;
  const Image full = render(PlanarIntegrator(model, golden.sampling), options).film.develop();
  Image image(16, 16, {"R", "G", "B", "variance.R", "variance.G", "variance.B"});
  for (int c = 0; c < 6; ++c) {
    const float* from = full.plane(full.find(image.channels()[static_cast<std::size_t>(c)]));
    std::copy(from, from + 256, image.plane(c));
  }
  return image;
}

std::filesystem::path golden_path(const Golden& golden) {
  return source_dir() / "tests/regression/golden" / (golden.file + ".exr");
}

void write_golden(const Golden& golden) {
  write_exr(golden_path(golden), render_golden(golden),
            {{"model", golden.model},
             {"samples", std::to_string(spp)},
             {"written_by", "ALABASTER_WRITE_GOLDENS=1 build/release/tests/test_regression"}});
}

bool same_bits(const Image& a, const Image& b) {
  for (int c = 0; c < 6; ++c)
    if (!std::equal(a.plane(c), a.plane(c) + 256, b.plane(c))) return false;
  return true;
}

}  // namespace

TEST_CASE("planar images are their golden ones") {
  const char* write = std::getenv("ALABASTER_WRITE_GOLDENS");
  if (write != nullptr && std::string(write) == "1")
    for (const Golden& golden : goldens) write_golden(golden);
  for (const Golden& golden : goldens) {
    const Image now = render_golden(golden);
    const Image then = read_exr(golden_path(golden)).image;
    REQUIRE(then.channels() == now.channels());
    int close = 0, all = 0;
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 256; ++i, ++all)
        close += std::abs(now.plane(c)[i] - then.plane(c)[i]) <= 1e-5f * std::abs(then.plane(c)[i]);
    INFO(golden.file << ": " << close << " of " << all << " values within 1e-5; see the head of this file");
    CHECK(close >= 0.999 * all);
    // The same samples: what differs beyond rounding must still be noise. Degrees of freedom of 16 groups.
    const ZTest z = z_test(now, then, 15);
    CHECK((z.tests == 0 || z.passes()));
  }
}

TEST_CASE("planar images are bit for bit the same at any number of threads") {
  for (const Golden& golden : goldens) {
    set_thread_count(1);
    const Image one = render_golden(golden);
    set_thread_count(5);
    const Image five = render_golden(golden);
    set_thread_count(0);
    INFO(golden.file);
    CHECK(same_bits(one, five));
  }
}
