#include "texture/gaussian_pyramid.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>

#include "core/rng.h"

using namespace alabaster;

namespace {

TexelArray make_texels(int width, int height, const std::function<Vec4f(int, int)>& value) {
  TexelArray texels{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) texels.texels.push_back(value(x, y));
  return texels;
}

float two_tone(bool bright) {
  return bright ? 0.95f : 0.5f;
}
constexpr double contrast = 0.45;

// The two-tone patterns of the accuracy tests: vertical stripes, a disk pattern, and random blocks.
TexelArray stripes(int size, int period) {
  return make_texels(size, size, [=](int x, int) { return Vec4f(two_tone(x % period < period / 2)); });
}
TexelArray disks(int size, int period) {
  return make_texels(size, size, [=](int x, int y) {
    const int dx = x % period - period / 2, dy = y % period - period / 2;
    return Vec4f(two_tone(9 * (dx * dx + dy * dy) < period * period));
  });
}
TexelArray blocks(int size, int block) {
  return make_texels(size, size, [=](int x, int y) {
    return Vec4f(
        two_tone(hash_combine(static_cast<uint64_t>(x / block), static_cast<uint64_t>(y / block)) & 1));
  });
}

// Integral of a texel's own footprint (tent: bilinear, box: nearest) against a Gaussian whose mean lies x
// texels away, in closed form.
double footprint_weight(double x, double sigma, Filter filter) {
  const auto cdf = [&](double t) { return 0.5 * std::erfc(-t / (sigma * std::sqrt(2.0))); };
  const auto twice = [&](double t) {
    return t * cdf(t) + sigma / std::sqrt(2 * pi) * std::exp(-0.5 * t * t / (sigma * sigma));
  };
  if (filter == Filter::nearest) return cdf(x + 0.5) - cdf(x - 0.5);
  return twice(x + 1) - 2 * twice(x) + twice(x - 1);
}

std::vector<double> axis_weights(double position, int size, double sigma, Wrap wrap, Filter filter) {
  std::vector<double> weights(static_cast<std::size_t>(size));
  const int reach = static_cast<int>(7 * sigma) + 2, centre = static_cast<int>(std::floor(position));
  for (int i = centre - reach; i <= centre + reach; ++i)
    if (wrap != Wrap::clamp || (i >= 0 && i < size))
      weights[static_cast<std::size_t>(wrap_index(i, size, wrap))] +=
          footprint_weight(i + 0.5 - position, sigma, filter);
  return weights;
}

// The exact average of the reconstructed texture under the Gaussian, coverage-weighted.
double brute_force(const TexelArray& texels, const std::vector<float>& coverage, Vec2 st, double sigma,
                   Wrap wrap, Filter filter = Filter::linear) {
  const auto u = axis_weights(st.x * texels.width, texels.width, sigma, wrap, filter);
  const auto v = axis_weights(st.y * texels.height, texels.height, sigma, wrap, filter);
  double sum = 0, weight = 0;
  std::size_t i = 0;
  for (const double wv : v)
    for (const double wu : u) {
      const double w = wu * wv * (coverage.empty() ? 1.0 : static_cast<double>(coverage[i]));
      sum += w * static_cast<double>(texels.texels[i++].x);
      weight += w;
    }
  return sum / weight;
}

struct Errors {
  double rms = 0, largest = 0;
};

Errors measure(const TexelArray& texels, const std::vector<float>& coverage, double sigma, Wrap wrap,
               int points, Filter filter = Filter::linear) {
  const GaussianPyramid pyramid(texels, coverage, wrap, wrap, filter);
  Rng rng(17);
  Errors errors;
  for (int n = 0; n < points; ++n) {
    const Vec2 st(rng.uniform(), rng.uniform());
    const double error =
        std::abs(pyramid.filtered(st, sigma).r - brute_force(texels, coverage, st, sigma, wrap, filter)) /
        contrast;
    errors.rms += error * error / points;
    errors.largest = std::max(errors.largest, error);
  }
  errors.rms = std::sqrt(errors.rms);
  return errors;
}

}  // namespace

TEST_CASE("lookups match the exact Gaussian average on two-tone textures, from 0.1 texel to a quarter") {
  const Filter filter = GENERATE(Filter::linear, Filter::nearest);
  const Wrap wrap = GENERATE(Wrap::repeat, Wrap::mirror, Wrap::clamp);
  for (const double sigma : {0.1, 0.33, 0.55, 1.0, 1.5, 2.3, 4.3, 11.0, 30.0})
    for (const TexelArray& texels : {stripes(128, 8), disks(120, 24), blocks(127, 5)}) {
      const Errors errors = measure(texels, {}, sigma, wrap, 25, filter);
      INFO("sigma " << sigma << " texture " << texels.width << " wrap " << static_cast<int>(wrap));
      CHECK(errors.rms < (filter == Filter::linear || sigma > 1 ? 0.01 : 0.02));
      CHECK(errors.largest < (filter == Filter::linear || sigma > 1 ? 0.016 : 0.05));
    }
}

TEST_CASE("lookups match the exact average where coverage is partial") {
  const TexelArray texels = blocks(96, 3);
  std::vector<float> coverage;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const int r2 = (x % 48 - 24) * (x % 48 - 24) + (y % 32 - 16) * (y % 32 - 16);
      coverage.push_back(r2 < 120 ? 1.0f : r2 < 160 ? 0.3f : 0.0f);
    }
  const GaussianPyramid pyramid(texels, coverage, Wrap::repeat, Wrap::repeat);
  Rng rng(5);
  for (const double sigma : {0.5, 2.0, 5.0, 20.0})
    for (int n = 0; n < 40; ++n) {
      const Vec2 st((24 + 8 * (rng.uniform() - 0.5)) / 96, (16 + 8 * (rng.uniform() - 0.5)) / 96);
      const double error =
          pyramid.filtered(st, sigma).r - brute_force(texels, coverage, st, sigma, Wrap::repeat);
      CHECK(std::abs(error) < 0.02 * contrast);
    }
}

TEST_CASE("a constant texture stays constant whatever the coverage, size, wrap and width") {
  Rng rng(9);
  for (const auto& [w, h] :
       {std::pair(1, 1), {2, 1}, {1, 7}, {3, 3}, {17, 5}, {64, 64}, {100, 37}, {5, 256}}) {
    std::vector<float> coverage(static_cast<std::size_t>(w * h));
    for (float& c : coverage) c = rng.uniform() < 0.3 ? 0.0f : static_cast<float>(rng.uniform());
    coverage.back() = 0.01f;
    const TexelArray texels = make_texels(w, h, [](int, int) { return Vec4f(0.7f, 0.999991f, 0, 1); });
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
      for (const auto& weights : {coverage, std::vector<float>()}) {
        const GaussianPyramid pyramid(texels, weights, wrap, wrap);
        for (int n = 0; n < 40; ++n) {
          const Vec2 st(3 * rng.uniform() - 1, 3 * rng.uniform() - 1);
          const double sigma = std::exp(12 * rng.uniform() - 5);
          const Mat2 stretched(sigma * sigma, 0.3 * sigma, 0.3 * sigma, 1 + sigma);
          for (const Rgb& c :
               {pyramid.at(st), pyramid.filtered(st, sigma), pyramid.filtered(st, stretched)}) {
            REQUIRE(std::abs(c.r - 0.7f) < 1e-6);
            REQUIRE(std::abs(c.g - 0.999991f) < 1e-6);
            REQUIRE(c.b == 0);
          }
        }
      }
  }
}

TEST_CASE("what is not covered never shows, not even NaN") {
  // One covered block of 6 x 6 in magenta and NaN; whatever is asked, the answer lies within the block's
  // values.
  const TexelArray texels = make_texels(64, 64, [](int x, int y) {
    if (x >= 20 && x < 26 && y >= 40 && y < 46) return Vec4f(0.2f, (x + y) % 2 ? 0.3f : 0.6f, 0.1f, 1);
    return (x + y) % 2 ? Vec4f(1, 0, 1, 1) : Vec4f(std::numeric_limits<float>::quiet_NaN());
  });
  std::vector<float> coverage(64 * 64);
  for (int y = 40; y < 46; ++y)
    for (int x = 20; x < 26; ++x) coverage[static_cast<std::size_t>(y * 64 + x)] = 0.5f;
  const GaussianPyramid pyramid(texels, coverage, Wrap::repeat, Wrap::clamp);
  Rng rng(2);
  for (int n = 0; n < 2000; ++n) {
    const Vec2 st(rng.uniform(), rng.uniform());
    const double sigma = std::exp(9 * rng.uniform() - 3);
    for (const Rgb& c : {pyramid.at(st), pyramid.filtered(st, sigma),
                         pyramid.filtered(st, Mat2(sigma * sigma, 0, 0, 0.01 * sigma * sigma))}) {
      REQUIRE(c.r == Approx(0.2).epsilon(1e-5));
      REQUIRE(c.g >= 0.3f - 1e-6);
      REQUIRE(c.g <= 0.6f + 1e-6);
    }
  }
  CHECK(pyramid.max() == Rgb(0.2f, 0.6f, 0.1f));
  CHECK(pyramid.mean().g == Approx(0.45));
}

TEST_CASE("the finest level is the texture's own reconstruction, widening is continuous") {
  const TexelArray texels = blocks(37, 2);
  const auto shared = std::make_shared<TexelArray>(texels);
  Rng rng(4);
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
    for (const Filter filter : {Filter::linear, Filter::nearest}) {
      const GaussianPyramid pyramid(texels, {}, wrap, wrap, filter);
      TextureMapping mapping;
      mapping.wrap_u = mapping.wrap_v = wrap;
      mapping.filter = filter;
      const Texture texture(shared, mapping);
      for (int n = 0; n < 200; ++n) {
        const Vec2 st(3 * rng.uniform() - 1, 3 * rng.uniform() - 1);
        INFO("st " << st.x << ", " << st.y << " wrap " << int(wrap) << " filter " << int(filter));
        REQUIRE(std::abs(pyramid.at(st).r - texture.evaluate(st).x) < 1e-5);
        REQUIRE(pyramid.filtered(st, 0).r == pyramid.at(st).r);
      }
      const Vec2 st(0.41, 0.37);
      double last = pyramid.filtered(st, 0.5).r;
      for (double sigma = 0.5; sigma < 200; sigma *= 1.002) {
        const double value = pyramid.filtered(st, sigma).r;
        REQUIRE(std::abs(value - last) < 0.012 * contrast);
        last = value;
      }
    }
}

TEST_CASE("what 16 bits lose is 1e-5 of the contrast, at full and at small weights") {
  Rng rng(23);
  const TexelArray texels = make_texels(64, 64, [&](int, int) {
    return Vec4f(float(0.2 + 0.7 * rng.uniform()), float(1e-3 * rng.uniform()), float(rng.uniform()), 1);
  });
  std::vector<float> coverage;
  for (int i = 0; i < 64 * 64; ++i) coverage.push_back(i % 7 == 0 ? 0.001f : 1.0f);
  for (const auto& weights : {std::vector<float>(), coverage}) {
    const GaussianPyramid pyramid(texels, weights, Wrap::repeat, Wrap::repeat);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const Rgb value = pyramid.at(Vec2(x + 0.5, y + 0.5) / 64.0);
        for (int c = 0; c < 3; ++c)
          REQUIRE(std::abs(value[c] - double(texels.at(x, y)[c])) < 1e-5 * (c == 1 ? 1e-3 : 1));
      }
  }
}

TEST_CASE("a huge Gaussian gives the coverage-weighted mean") {
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
    for (const auto& [w, h] : {std::pair(64, 64), {5, 200}, {1, 9}, {33, 2}}) {
      const TexelArray texels = make_texels(w, h, [w = w](int x, int y) { return Vec4f(float(x + w * y)); });
      std::vector<float> coverage;
      double sum = 0, weight = 0;
      for (int i = 0; i < w * h; ++i) {
        coverage.push_back(i % 3 ? 1.0f : 0.25f);
        sum += i * static_cast<double>(coverage.back());
        weight += static_cast<double>(coverage.back());
      }
      const GaussianPyramid pyramid(texels, coverage, wrap, wrap);
      CHECK(pyramid.filtered({0.1, 0.9}, 20.0 * std::max(w, h)).r == Approx(sum / weight).epsilon(1e-5));
      CHECK(pyramid.filtered({0.1, 0.9}, std::numeric_limits<double>::infinity()).r ==
            Approx(sum / weight).epsilon(1e-5));
      CHECK(pyramid.filtered({0.1, 0.9}, 1e300).r == Approx(sum / weight).epsilon(1e-5));
    }
}

TEST_CASE("a stretched Gaussian along an axis matches the exact average") {
  // The exact average of a separable Gaussian: different widths on either axis.
  const TexelArray texels = blocks(128, 6);
  const GaussianPyramid pyramid(texels, {}, Wrap::repeat, Wrap::repeat);
  Rng rng(8);
  for (const auto& [su, sv] : {std::pair(2.0, 2.6), {3.0, 8.0}, {12.0, 2.0}, {1.0, 5.0}})
    for (int n = 0; n < 40; ++n) {
      const Vec2 st(rng.uniform(), rng.uniform());
      const auto u = axis_weights(st.x * 128, 128, su, Wrap::repeat, Filter::linear);
      const auto v = axis_weights(st.y * 128, 128, sv, Wrap::repeat, Filter::linear);
      double exact = 0;
      for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x)
          exact +=
              u[static_cast<std::size_t>(x)] * v[static_cast<std::size_t>(y)] * double(texels.at(x, y).x);
      INFO("deviations " << su << ", " << sv);
      CHECK(std::abs(pyramid.filtered(st, Mat2(su * su, 0, 0, sv * sv)).r - exact) < 0.02 * contrast);
    }
}

TEST_CASE("a stretched Gaussian turns with its covariance") {
  // On a linear ramp any centred kernel gives the value at the centre; on its square, centre^2 + variance.
  const TexelArray texels = make_texels(256, 256, [](int x, int y) {
    const float along = float(0.8 * (x - 127.5) + 0.6 * (y - 127.5));
    return Vec4f(along, along * along, 0, 1);
  });
  const GaussianPyramid pyramid(texels, {}, Wrap::clamp, Wrap::clamp);
  const Vec2 long_axis(0.8, 0.6), short_axis(-0.6, 0.8);
  for (const auto& [across, along] : {std::pair(4.0, 5.0), {4.0, 12.0}, {2.0, 9.0}, {10.0, 3.0}}) {
    Mat2 covariance = along * along * glm::outerProduct(long_axis, long_axis) +
                      across * across * glm::outerProduct(short_axis, short_axis);
    const Rgb value = pyramid.filtered({0.5, 0.5}, covariance);
    CHECK(value.r == Approx(0).margin(0.02));
    // The ramp's own reconstruction adds 1/6 where the slope is 1 per texel.
    CHECK(value.g == Approx(along * along + 1.0 / 6).epsilon(0.03));
  }
}

TEST_CASE("broken coordinates and covariances give finite answers") {
  const GaussianPyramid pyramid(blocks(16, 2), {}, Wrap::repeat, Wrap::mirror);
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity, 1e300}) {
    CHECK(pyramid.at({bad, 0.5}).is_finite());
    CHECK(pyramid.filtered({0.5, bad}, 2).is_finite());
    CHECK(pyramid.filtered({0.5, 0.5}, bad).is_finite());
    CHECK(pyramid.filtered({0.5, 0.5}, Mat2(bad, 0, 0, 1)).is_finite());
    CHECK(pyramid.filtered({0.5, 0.5}, Mat2(1, bad, bad, 1)).is_finite());
  }
  CHECK(pyramid.filtered({0.5, 0.5}, Mat2(0.0)).r == pyramid.at({0.5, 0.5}).r);
}

TEST_CASE("the pyramid takes three quarters of the memory of a float texture") {
  constexpr int size = 1024;  // margins around the levels make it more where textures are small
  const GaussianPyramid pyramid(blocks(size, 3), {}, Wrap::repeat, Wrap::repeat);
  CHECK(double(pyramid.memory_bytes()) < 0.74 * size * size * sizeof(Vec4f));
}

TEST_CASE("pyramid accuracy table", "[.][bench]") {
  std::printf("%8s | %-17s | %-17s | %-17s | %-17s (rms, largest; %% of contrast)\n", "sigma", "stripes 8",
              "stripes 32", "disks 24", "blocks 5");
  for (double sigma = 0.1; sigma <= 64.1; sigma *= std::sqrt(std::sqrt(2.0))) {
    std::printf("%8.2f", sigma);
    for (const TexelArray& t : {stripes(256, 8), stripes(256, 32), disks(240, 24), blocks(200, 5)}) {
      const Errors e = measure(t, {}, sigma, Wrap::repeat, 60);
      std::printf(" | %7.3f  %7.3f ", 100 * e.rms, 100 * e.largest);
    }
    std::printf("\n");
  }
}

TEST_CASE("pyramid lookups per second", "[.][bench]") {
  const TexelArray texels = blocks(1024, 3);
  const auto begin = std::chrono::steady_clock::now();
  const GaussianPyramid pyramid(texels, {}, Wrap::repeat, Wrap::repeat);
  std::printf("build 1024^2: %.3f s, memory %.3f of the texture\n",
              std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
              double(pyramid.memory_bytes()) / (1024 * 1024 * 16));
  for (const double sigma : {0.0, 0.3, 0.6, 1.0, 1.4, 2.0, 4.0, 10.0, 40.0, 200.0}) {
    Rng rng(3);
    constexpr int count = 1000000;
    double sum = 0;
    Vec2 st(0.5);
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < count; ++i) {
      st += 0.01 * Vec2(rng.uniform() - 0.5, rng.uniform() - 0.5);
      sum += pyramid.filtered(st, sigma).r;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("sigma %6.1f: %6.1f ns (%g)\n", sigma, 1e9 * seconds / count, sum / count);
  }
}
