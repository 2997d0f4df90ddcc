#include "study/image_errors.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/rng.h"
#include "core/vec.h"

using namespace alabaster;

namespace {

const std::vector<std::string> channels{"R", "G", "B", "A", "variance.R", "variance.G", "variance.B"};

double gaussian(Rng& rng) {
  return std::sqrt(-2 * std::log(rng.uniform_positive())) * std::cos(2 * pi * rng.uniform());
}

/// `value` times 1 + noise x normal, with that variance written down.
Image noisy(double value, double noise, Rng& rng) {
  Image image(64, 64, channels);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        image.at(c, x, y) = static_cast<float>(value * (1 + noise * gaussian(rng)));
        image.at(4 + c, x, y) = static_cast<float>(value * value * noise * noise);
      }
  return image;
}

}  // namespace

TEST_CASE("measures of images that differ by a factor are exact") {
  Rng rng(1);
  const ImageErrors e = image_errors(noisy(1.2, 0, rng), noisy(1, 0, rng));
  CHECK(e.rmse_over_rms == Approx(0.2).epsilon(1e-5));
  CHECK(e.bias == Approx(0.2).epsilon(1e-5));
  CHECK(e.noise == 0);
  CHECK(e.mean_bias == Approx(0.2).epsilon(1e-5));
  CHECK(e.mean_abs_log_ratio == Approx(std::log(1.2)).epsilon(1e-5));
  CHECK(e.kept == 1);
  CHECK(e.bias_interval == 0);
}

TEST_CASE("the bias is what noise leaves, within its interval") {
  int covered = 0, mean_covered = 0;
  for (uint64_t seed = 0; seed < 100; ++seed) {
    Rng rng(seed);
    const ImageErrors e = image_errors(noisy(1.05, 0.1, rng), noisy(1, 0.02, rng));
    covered += std::abs(e.bias - 0.05) < e.bias_interval;
    mean_covered += std::abs(e.mean_bias - 0.05) < e.mean_bias_interval;
    CHECK(e.noise == Approx(std::sqrt(0.105 * 0.105 + 0.02 * 0.02)).epsilon(0.01));
  }
  // 95 of 100 expected; binomial at 1e-4.
  CHECK(covered >= 86);
  CHECK(mean_covered >= 86);
}

TEST_CASE("log ratios are capped, and pixels the reference does not know are left out and counted") {
  Rng rng(1);
  Image a = noisy(1, 0, rng), b = noisy(1, 0, rng);
  a.at(0, 0, 0) = 0;
  for (int x = 0; x < 64; ++x) b.at(4, x, 1) = 0.02f;  // standard error above a tenth
  const ImageErrors e = image_errors(a, b);
  const double values = 3 * 64 * 64;
  CHECK(e.kept == Approx(1 - 64 / values));
  CHECK(e.mean_abs_log_ratio == Approx(std::log(1000.0) / (values - 64)).epsilon(1e-5));
}
