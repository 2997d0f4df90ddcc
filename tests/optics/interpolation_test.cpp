#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "core/vec.h"
#include "optics/fast_math.h"
#include "optics/mixture_profile.h"
#include "optics/monotone_curve.h"
#include "optics/profile_store.h"
#include "optics/table_data.h"

using namespace alabaster;

TEST_CASE("fast logarithm and exponential keep their stated errors") {
  for (double x = -80; x < 80; x += 0.0137) {
    const auto value = static_cast<float>(std::exp2(x));
    const double exact = std::log(double{value});
    REQUIRE(std::abs(fast_log(value) - exact) < 3e-7 * std::max(1.0, std::abs(exact)));
    if (std::abs(x) < 8)
      REQUIRE(fast_exp2(static_cast<float>(x)) ==
              Approx(std::exp2(double{static_cast<float>(x)})).epsilon(3e-7));
  }
  const Float4 four = fast_exp2(Float4{-200, -1, 0, 3});
  CHECK(four[0] > 0);
  CHECK(four[1] == Approx(0.5).epsilon(3e-7));
  CHECK(four[2] == 1);
  CHECK(four[3] == Approx(8).epsilon(3e-7));
  // Lanes are numbers.
  const Float8 numbers{1e-30f, 0.003f, 0.7f, 1, 1.5f, 3, 200, 1e20f}, logs = fast_log2(numbers);
  for (int i = 0; i < 8; ++i) CHECK(logs[i] == fast_log2(float{numbers[i]}));
}

TEST_CASE("a monotone curve passes through its points, keeps their order and inverts") {
  const MonotoneCurve curve({0, 0.1, 0.15, 0.9, 0.95, 3});
  CHECK(curve(0) == 0);
  CHECK(curve(2) == Approx(0.15));
  CHECK(curve(5) == Approx(3));
  CHECK(curve(99) == Approx(3));
  double before = -1;
  for (double x = 0; x <= 5; x += 0.001) {
    REQUIRE(curve(x) >= before);
    before = curve(x);
  }
  for (double value = 0.01; value < 3; value += 0.01) REQUIRE(curve(curve.inverse(value)) == Approx(value));
  // The derivative is continuous across points.
  for (double x = 1; x < 5; x += 1)
    CHECK((curve(x + 1e-6) - curve(x)) == Approx(curve(x) - curve(x - 1e-6)).margin(1e-10));
}

TEST_CASE("albedo rows invert their position and reach both ends") {
  CHECK(AlbedoRows::position(1) == 0);
  CHECK(AlbedoRows::albedo(0) == 1);
  CHECK(AlbedoRows::position(0) == Approx(AlbedoRows::count - 1));
  CHECK(AlbedoRows::albedo(AlbedoRows::count - 1) == 0);
  for (double x = 1; x < AlbedoRows::count - 1; x += 0.37)
    REQUIRE(AlbedoRows::position(AlbedoRows::albedo(x)) == Approx(x).epsilon(1e-6));
}

TEST_CASE("profiles vary smoothly with the albedo: no kink at any row") {
  // One-sided slopes of ln R over the row position, left and right of every row, against the change of slope
  // that a row's width brings anyway. A piecewise linear table fails this by a factor of hundreds.
  const MixtureProfile mixture(baseline_table());
  const ProfileTable* profiles[]{&baseline_profile(), &mixture};
  for (const ProfileTable* profile : profiles)
    for (const double rho : {0.05, 0.5, 3.0, 20.0})
      for (int row = 24; row + 8 < AlbedoRows::count; ++row) {
        const auto log_density = [&](double position) {
          return std::log(profile->evaluate_over_albedo(AlbedoRows::albedo(position), rho));
        };
        const double h = 0.02, at = log_density(row);
        const double left = (at - log_density(row - h)) / h, right = (log_density(row + h) - at) / h;
        const double wide = std::abs(log_density(row + 1) - 2 * at + log_density(row - 1));
        INFO("rho " << rho << ", row " << row << ": slopes " << left << ", " << right);
        // Single precision leaves up to 2e-6 |ln R| / h at either side; the second derivative of either
        // spline is at most a few times `wide`.
        REQUIRE(std::abs(right - left) <
                4e-4 * std::max(1.0, std::abs(at)) + 8 * h * wide + 0.02 * std::abs(left));
      }
}

TEST_CASE("the mixture's sampling and density belong together") {
  const MixtureProfile mixture(baseline_table());
  for (const double albedo : {0.0, 0.5, 0.99, 1.0}) {
    // Mean of 1/(1 + rho) by sampling and by integrating the density.
    const int samples = 100000;
    double sum = 0, square = 0;
    Rng rng(9);
    for (int i = 0; i < samples; ++i) {
      const double value = 1 / (1 + mixture.sample(albedo, rng.uniform()));
      sum += value, square += value * value;
    }
    double expected = 0;
    const double step = 0.001;
    for (double x = -30; x < 40; x += step) {
      const double rho = std::exp2(x + 0.5 * step);
      REQUIRE(mixture.pdf(albedo, rho) > 0);
      expected += mixture.pdf(albedo, rho) / (1 + rho) * rho * step * std::log(2.0);
    }
    const double mean = sum / samples, error = std::sqrt((square / samples - mean * mean) / samples);
    CHECK(std::abs(mean - expected) < 4 * error);
  }
  for (double wanted = 0.01; wanted < 0.98; wanted += 0.05)
    CHECK(mixture.reflectance(mixture.albedo_from_reflectance(wanted)) == Approx(wanted).margin(1e-4));
}

TEST_CASE("the mixture stays near the table it was fitted to") {
  const MixtureProfile mixture(baseline_table());
  double sum = 0;
  int count = 0;
  for (double position = 4; position < AlbedoRows::count - 1; position += 3.3) {
    const double albedo = AlbedoRows::albedo(position);
    CHECK(mixture.reflectance(albedo) == Approx(baseline_profile().reflectance(albedo)).epsilon(1e-12));
    const double length = std::min(200.0, 1 / std::sqrt(3 * (1 - albedo) * (1 - 0.3 * albedo)));
    for (double x = 0.02; x < 8; x *= 1.5, ++count)
      sum += std::abs(std::log(mixture.evaluate_over_albedo(albedo, x * length) /
                               baseline_profile().evaluate_over_albedo(albedo, x * length)));
  }
  CHECK(sum / count < 0.06);
}
