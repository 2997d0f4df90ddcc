#include "scene/film.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/statistics.h"

using namespace alabaster;

namespace {

// A pixel of two decisions whose value is smooth in one and has an edge in the other.
double value(const Sampler& sampler) {
  const Vec2 u = sampler.get_2d(Dimension::pixel);
  return u.x * u.x + (u.x + u.y > 1.2 ? 1.0 : 0.0) + 0.5 * sampler.get_1d(Dimension::lobe);
}

struct Estimates {
  double true_variance = 0;  // of the mean, across pixels
  double mean_estimate = 0, error_of_mean_estimate = 0;
};

// Every pixel renders the same integral with random numbers of its own.
Estimates estimate(SamplerKind kind, uint32_t spp) {
  const int side = 64;
  Film film(side, side, kind);
  Sampler sampler(kind, 3);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (uint32_t k = 0; k < spp; ++k) {
        sampler.start(x, y, k);
        film.add(x, y, Rgb(value(sampler)), 1, nullptr);
      }
  const Image image = film.develop();
  RunningMoments pixels, variances;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      pixels.add(image.at(0, x, y));
      variances.add(image.at(4, x, y));
    }
  return {pixels.variance(), variances.mean(), variances.standard_error()};
}

}  // namespace

TEST_CASE("the estimated variance of the mean is the true one (z-test, 4 standard errors)") {
  for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent})
    for (const uint32_t spp : {8u, 64u, 128u, 192u, 256u}) {
      const Estimates e = estimate(kind, spp);
      // The variance of n normal values has the relative standard error sqrt(2 / (n - 1)).
      const double error =
          std::hypot(e.true_variance * std::sqrt(2.0 / (64 * 64 - 1)), e.error_of_mean_estimate);
      INFO("spp " << spp << (kind == SamplerKind::sobol ? " sobol" : " independent"));
      CHECK(std::abs(e.mean_estimate - e.true_variance) < 4 * error);
    }
}

TEST_CASE("where groups are unfinished the variance errs on the safe side") {
  const Estimates sample = estimate(SamplerKind::independent, 1);  // true_variance: of a single sample
  for (const uint32_t spp : {2u, 4u, 7u, 11u, 67u, 70u, 198u}) {
    const Estimates e = estimate(SamplerKind::sobol, spp);
    INFO("spp " << spp);
    const double error =
        std::hypot(e.true_variance * std::sqrt(2.0 / (64 * 64 - 1)), e.error_of_mean_estimate);
    CHECK(e.mean_estimate > e.true_variance - 4 * error);
    CHECK(e.mean_estimate < 1.2 * sample.true_variance / (spp - 1));
  }
}

TEST_CASE("Sobol samples have a lower variance than independent ones, and the film says so") {
  const Estimates sobol = estimate(SamplerKind::sobol, 256);
  const Estimates independent = estimate(SamplerKind::independent, 256);
  CHECK(sobol.mean_estimate < 0.5 * independent.mean_estimate);
}

TEST_CASE("a film without samples develops to nothing, and few samples are valid") {
  Film film(2, 1, SamplerKind::sobol);
  const Film::Auxiliary first{Rgb(0.5), Vec3(0, 0, 1), 2.0};
  film.add(1, 0, Rgb(1, 2, 3), 1, &first);
  const Image image = film.develop();
  for (std::size_t c = 0; c < image.channels().size(); ++c) CHECK(image.at(static_cast<int>(c), 0, 0) == 0);
  CHECK(image.rgb(0, 1, 0) == Rgb(1, 2, 3));
  CHECK(image.rgb(4, 1, 0) == Rgb(1, 4, 9));  // a single sample: its square
  CHECK(image.at(image.find("samples.Y"), 1, 0) == 1);
  CHECK(image.at(image.find("depth.Z"), 1, 0) == 2);
}

TEST_CASE("the first hit's data are averaged over the samples that hit") {
  Film film(1, 1, SamplerKind::independent);
  const Film::Auxiliary a{Rgb(0.2), Vec3(0, 0, 1), 1.0}, b{Rgb(0.4), Vec3(0, 1, 0), 3.0};
  film.add(0, 0, Rgb(1), 1, &a);
  film.add(0, 0, Rgb(1), 0, nullptr);
  film.add(0, 0, Rgb(1), 1, &b);
  const Image image = film.develop();
  CHECK(image.at(image.find("A"), 0, 0) == Approx(2.0 / 3));
  CHECK(image.at(image.find("albedo.R"), 0, 0) == Approx(0.3));
  CHECK(image.at(image.find("normal.Y"), 0, 0) == Approx(0.5));
  CHECK(image.at(image.find("depth.Z"), 0, 0) == Approx(2));
}
