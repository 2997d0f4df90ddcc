#include "texture/plane_pyramid.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/rng.h"

using namespace alabaster;

namespace {

TexelArray random_texels(int width, int height, bool grey) {
  TexelArray texels{width, height, {}};
  Rng rng(7);
  for (int i = 0; i < width * height; ++i) {
    const auto value = [&] { return static_cast<float>(0.2 + 0.75 * rng.uniform()); };
    const float r = value();
    texels.texels.push_back(grey ? Vec4f(r, r, r, 1) : Vec4f(r, value(), value(), 1));
  }
  return texels;
}

}  // namespace

TEST_CASE("planes average as the Gaussian pyramid does, one to four Gaussians at once") {
  struct Case {
    int width, height;
    bool grey;
  };
  for (const Case& c :
       {Case{400, 400, true}, Case{400, 400, false}, Case{37, 37, false}, Case{64, 20, true}}) {
    const TexelArray texels = random_texels(c.width, c.height, c.grey);
    const PlanePyramid planes(texels);
    const GaussianPyramid pyramid(texels, {}, Wrap::repeat, Wrap::repeat);
    Rng rng(1);
    for (int i = 0; i < 1000; ++i) {
      std::vector<PlanePyramid::Gaussian> gaussians;
      Rgb expected;
      for (int k = 0; k <= i % 4; ++k) {
        // From far below a texel to more than the whole texture.
        const double sigma = 0.05 * std::pow(30.0 * c.width, rng.uniform());
        gaussians.push_back({{6 * rng.uniform() - 3, 6 * rng.uniform() - 3}, sigma, rng.uniform()});
        expected += gaussians.back().weight * pyramid.filtered(gaussians.back().st, sigma);
      }
      const Rgb sum = planes.sum(gaussians, pyramid);
      // The other's samples have 16 bits.
      for (int channel = 0; channel < 3; ++channel)
        REQUIRE(sum[channel] == Approx(expected[channel]).epsilon(2e-5));
    }
  }
}

TEST_CASE("planes of one albedo average to it") {
  const TexelArray texels{8, 8, std::vector<Vec4f>(64, Vec4f(0.7f, 0.8f, 0.9f, 1))};
  const GaussianPyramid pyramid(texels, {}, Wrap::repeat, Wrap::repeat);
  const std::vector<PlanePyramid::Gaussian> gaussians{{{0.3, 0.6}, 1, 0.25}, {{0.1, 0.2}, 2.5, 0.75}};
  const Rgb sum = PlanePyramid(texels).sum(gaussians, pyramid);
  for (int c = 0; c < 3; ++c) CHECK(sum[c] == Approx(static_cast<double>(texels.at(0, 0)[c])).epsilon(1e-6));
}
