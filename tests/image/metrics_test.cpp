#include "image/metrics.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"
#include "core/statistics.h"

using namespace alabaster;

namespace {

const std::vector<std::string> with_variance{"R", "G", "B", "variance.R", "variance.G", "variance.B"};

Image constant(int size, double value, double variance = -1) {
  Image image(size, size, variance >= 0 ? with_variance : std::vector<std::string>{"R", "G", "B"});
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      image.set_rgb(0, x, y, Rgb(value));
      if (variance >= 0) image.set_rgb(3, x, y, Rgb(variance));
    }
  return image;
}

// Adds Gaussian noise whose variance the image states.
void add_noise(Image& image, uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        const double sigma = std::sqrt(static_cast<double>(image.at(c + 3, x, y)));
        image.at(c, x, y) += static_cast<float>(sigma * normal(engine));
      }
}

}  // namespace

TEST_CASE("closed-form metrics of two constants") {
  const Metrics m = compare_images(constant(4, 1.2, 0.01), constant(4, 1, 0.0025));
  CHECK(m.rmse_over_rms == Approx(0.2));
  CHECK(*m.bias == Approx(std::sqrt(0.04 - 0.0125)));
  CHECK(*m.noise == Approx(std::sqrt(0.0125)));
  CHECK(m.mean_bias == Approx(0.2));
  CHECK(m.mean_abs_log_ratio == Approx(std::log(1.2)));
  CHECK(m.kept == 1);
  CHECK(m.rel_mse == Approx(0.04 / 1.01));
  CHECK(m.mean_a == Approx(1.2));
  CHECK(m.mean_b == Approx(1));
  CHECK(m.pixels == 16);
  CHECK(m.finite);
}

TEST_CASE("a noisy but unbiased picture has bias 0 and its own noise, within what chance allows") {
  // Per value, d = (a - b)^2 - var_a - var_b has mean 0 and variance 2 (var_a + var_b)^2.
  const double value = 2, var_a = 0.25, var_b = 0.04;
  int outside = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Image a = constant(64, value, var_a), b = constant(64, value, var_b);
    add_noise(a, 2 * seed);
    add_noise(b, 2 * seed + 1);
    const Metrics m = compare_images(a, b);
    const double count = 64 * 64 * 3, power = value * value + var_b;
    const double x = std::copysign(*m.bias * *m.bias, *m.bias) * power;
    const double z = x / (std::sqrt(2 / count) * (var_a + var_b));
    if (two_sided_normal_p_value(z) < sidak(0.001, 20)) ++outside;
    CHECK(*m.noise == Approx(std::sqrt((var_a + var_b) / power)).epsilon(0.01));
  }
  CHECK(outside == 0);
}

TEST_CASE("a known bias is found under noise of the same size") {
  // a = 1.1 value: x = (0.1 value)^2 / mean b^2.
  const double value = 3, var = 0.09;
  Image a = constant(128, 1.1 * value, var), b = constant(128, value, var);
  add_noise(a, 1);
  add_noise(b, 2);
  const Metrics m = compare_images(a, b);
  const double power = value * value + var, count = 128 * 128 * 3;
  // d = (a - b)^2 - 2 var, variance 2 (2 var)^2 + 4 (2 var) bias^2.
  const double bias2 = 0.09 * value * value / 9,
               spread = std::sqrt((8 * var * var + 8 * var * bias2) / count);
  CHECK(two_sided_normal_p_value((*m.bias * *m.bias * power - bias2) / spread) > 0.001);
  CHECK(m.rmse_over_rms > 1.5 * *m.bias);
}

TEST_CASE("the log ratio leaves out what the reference does not know") {
  Image a = constant(10, 2, 0), b = constant(10, 1, 1e-6);
  for (int x = 0; x < 10; ++x) b.set_rgb(3, x, 0, Rgb(1));  // a row of pure noise: 10 of 100 pixels
  for (int x = 0; x < 10; ++x) b.set_rgb(0, x, 1, Rgb(1e-9)), b.set_rgb(3, x, 1, Rgb(0));  // dark, but known
  for (int x = 0; x < 10; ++x) b.set_rgb(0, x, 2, Rgb(0)), b.set_rgb(3, x, 2, Rgb(0));     // black
  for (int x = 0; x < 10; ++x) a.set_rgb(0, x, 3, Rgb(-1));                                // a negative
  const Metrics m = compare_images(a, b);
  CHECK(m.kept == Approx(70.0 / 80));
  CHECK(m.mean_abs_log_ratio == Approx((20 * std::log(1000.0) + 60 * std::log(2.0)) / 80));
}

TEST_CASE("missing variances, NaN, masks, scale and sizes") {
  const Metrics plain = compare_images(constant(4, 2), constant(4, 1, 0.1));
  CHECK_FALSE(plain.bias);
  CHECK_FALSE(plain.noise);
  CHECK(plain.rmse_over_rms == Approx(1));
  CHECK(compare_images(constant(4, 2), constant(4, 1)).mean_abs_log_ratio == Approx(std::log(2.0)));

  Image broken = constant(4, 1);
  broken.at(1, 2, 3) = std::numeric_limits<float>::quiet_NaN();
  broken.at(2, 0, 0) = std::numeric_limits<float>::infinity();
  const Metrics partly = compare_images(broken, constant(4, 1));
  CHECK_FALSE(partly.finite);
  CHECK(partly.pixels == 14);
  CHECK(partly.rmse_over_rms == 0);

  CompareOptions masked;
  masked.mask.assign(16, false);
  masked.mask[5] = true;
  CHECK(compare_images(broken, constant(4, 1), masked).finite);
  CHECK(compare_images(broken, constant(4, 1), masked).pixels == 1);
  masked.mask[5] = false;
  CHECK_THROWS_AS(compare_images(broken, constant(4, 1), masked), InputError);

  CompareOptions fitted;
  fitted.fit_scale = true;
  const Metrics scaled = compare_images(constant(4, 8, 0.64), constant(4, 2, 0), fitted);
  CHECK(scaled.scale == Approx(0.25));
  CHECK(scaled.rmse_over_rms == Approx(0).margin(1e-7));
  CHECK(*scaled.noise == Approx(0.1));  // the variance is scaled along

  CHECK_THROWS_WITH(compare_images(constant(4, 1), constant(5, 1), {}, "a.exr", "b.exr"),
                    Catch::Contains("a.exr") && Catch::Contains("5 x 5"));
  CHECK_THROWS_AS(compare_images(Image(2, 2, {"depth.Z"}), constant(2, 1)), InputError);
  const Metrics black = compare_images(constant(4, 0), constant(4, 0));
  CHECK(black.rmse_over_rms == 0);
  CHECK(black.rel_mse == 0);
  CHECK(std::isnan(black.mean_abs_log_ratio));
}

TEST_CASE("the 95 % intervals of bias and mean cover the truth as often as they say") {
  int covered = 0, mean_covered = 0;
  for (uint64_t seed = 0; seed < 100; ++seed) {
    Image a = constant(64, 1.05, 0.011025), b = constant(64, 1, 0.0004);
    add_noise(a, 2 * seed);
    add_noise(b, 2 * seed + 1);
    const Metrics m = compare_images(a, b);
    covered += std::abs(*m.bias - 0.05) < *m.bias_interval;
    mean_covered += std::abs(m.mean_bias - 0.05) < *m.mean_bias_interval;
  }
  // 95 of 100 expected; binomial at 1e-4.
  CHECK(covered >= 86);
  CHECK(mean_covered >= 86);
  CHECK(covered < 100);
}

TEST_CASE("a grey picture knows a third of what its three channels seem to say") {
  Image a = constant(64, 1.2, 0.01), b = constant(64, 1, 0.0001);
  const Metrics grey = compare_images(a, b);
  a.at(0, 0, 0) += 1e-6f;
  const Metrics colour = compare_images(a, b);
  CHECK(*grey.mean_bias_interval == Approx(std::sqrt(3) * *colour.mean_bias_interval));
  CHECK(*grey.bias_interval > *colour.bias_interval);
}

TEST_CASE("without variances there are no intervals") {
  const Metrics m = compare_images(constant(4, 1.2), constant(4, 1));
  CHECK_FALSE(m.bias_interval);
  CHECK_FALSE(m.mean_bias_interval);
  CHECK_FALSE(m.log_interval);
}
