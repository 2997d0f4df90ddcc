#include "study/planar_to_noise.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "image/metrics.h"
#include "support/planar_scenes.h"
#include "support/z_test.h"

using namespace alabaster;

namespace {

double mean_noise(const Image& image) {
  double variance = 0, square = 0;
  for (const char* channel : {"R", "G", "B"})
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) {
        const float value = image.at(image.find(channel), x, y);
        square += static_cast<double>(value) * static_cast<double>(value);
        variance += static_cast<double>(image.at(image.find(std::string("variance.") + channel), x, y));
      }
  return std::sqrt(variance / square);
}

PlanarScene scene_with_dim_pixels() {
  PlanarScene scene = coloured_planar_scene();
  scene.light.radius = 0.7;
  return scene;
}

}  // namespace

TEST_CASE("an image to a noise has that noise, for fewer samples than even ones need") {
  const PlanarScene scene = scene_with_dim_pixels();
  const PlanarMethod method = parse_planar_method("composite");
  const TimedImage shared = render_planar_to_noise(scene, method, baseline_profile(), 0.02, 1);
  CHECK(mean_noise(shared.image) <= 0.02);
  CHECK(mean_noise(shared.image) > 0.01);
  // And it is off by no more: 64 pixels and three channels, three deviations of as many degrees of freedom as
  // pixels at the least.
  const Image truth = render_planar(scene, method, baseline_profile(), 8192, 7).image;
  CHECK(compare_images(shared.image, truth).rmse_over_rms < 0.02 * (1 + 3 / std::sqrt(2 * 64.0)));
  const auto per_pixel = static_cast<uint32_t>(shared.samples / 64);
  const TimedImage even = render_planar(scene, method, baseline_profile(), per_pixel, 1);
  CHECK(mean_noise(even.image) > 1.2 * mean_noise(shared.image));
}

TEST_CASE("an image to a noise is unbiased (z-test of the mean over 400 seeds, 1e-3)") {
  // Few samples, so that a share that depended on the pixel's own samples would show.
  const PlanarScene scene = scene_with_dim_pixels();
  const PlanarMethod method = parse_planar_method("homogeneous");
  const Image truth = render_planar(scene, method, baseline_profile(), 4096, 77).image;
  constexpr int seeds = 400;
  double sum = 0, squares = 0;
  for (uint64_t seed = 1; seed <= seeds; ++seed) {
    const Image image = render_planar_to_noise(scene, method, baseline_profile(), 0.2, seed).image;
    double relative = 0;  // of all pixels alike, the dim ones included
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) relative += static_cast<double>(image.at(1, x, y) / truth.at(1, x, y));
    sum += relative / 64;
    squares += std::pow(relative / 64, 2);
  }
  const double mean = sum / seeds, error = std::sqrt((squares / seeds - mean * mean) / (seeds - 1));
  CHECK(two_sided_normal_p_value((mean - 1) / std::hypot(error, 3e-4)) > 1e-3);
}
