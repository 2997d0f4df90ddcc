#include "optics/tabulated_profile.h"

#include <catch2/catch.hpp>
#include <vector>

#include "core/rng.h"
#include "core/statistics.h"
#include "core/vec.h"

using namespace alabaster;

namespace {

const TabulatedProfile& baseline() {
  return dynamic_cast<const TabulatedProfile&>(baseline_profile());
}
const std::vector<double> albedos{0, 0.05, 0.3, 0.5, 0.77, 0.9, 0.99, 0.999, 0.9999, 0.99999, 1};

}  // namespace

TEST_CASE("the built-in table is the baseline's") {
  CHECK(baseline().g() == 0.3);
  CHECK(baseline().eta() == 1.5);
  CHECK(baseline().reflectance(0) == 0);
  CHECK(baseline().reflectance(1) == 1);
}

TEST_CASE("reflectance increases and is inverted to better than 1e-4") {
  double before = -1;
  for (int i = 0; i <= 2000; ++i) {
    const double root = 1 - i / 2000.0, value = baseline().reflectance(1 - root * root);
    REQUIRE(value > before);
    before = value;
  }
  for (int i = 0; i <= 980; ++i) {
    const double wanted = i / 1000.0;
    REQUIRE(baseline().reflectance(baseline().albedo_from_reflectance(wanted)) ==
            Approx(wanted).margin(1e-9));
  }
}

TEST_CASE("the profile integrates to its reflectance") {
  for (const double albedo : albedos) {
    const double step = 1.0 / 256;
    double sum = 0;
    for (double x = -20; x < 30; x += step) {
      const double rho = std::exp2(x);
      sum += baseline().evaluate_over_albedo(albedo, rho) * 2 * pi * rho * rho * step * std::log(2.0);
    }
    // 1e-3 at alpha = 1, where the power law beyond the last node holds what lies further than 2^13.
    CHECK(albedo * sum == Approx(baseline().reflectance(albedo)).epsilon(1e-3).margin(1e-6));
  }
}

TEST_CASE("three channels in one call equal three calls") {
  const Rgb albedo(0.2, 0.9, 0.999);
  for (const double rho : {1e-5, 0.01, 0.7, 12.0, 3000.0, 1e6}) {
    const Rgb one = baseline().evaluate_over_albedo(albedo, rho);
    const Rgb each = baseline().evaluate_over_albedo(albedo, Rgb(rho, 2 * rho, 3 * rho));
    for (int c = 0; c < 3; ++c) {
      CHECK(one[c] == baseline().evaluate_over_albedo(albedo[c], rho));
      CHECK(each[c] == baseline().evaluate_over_albedo(albedo[c], (c + 1) * rho));
      CHECK(one[c] > 0);
    }
  }
}

TEST_CASE("sampling is the quantile function of the stated density") {
  for (const double albedo : albedos) {
    double before = 0;
    for (int i = 0; i < 4000; ++i) {
      const double u = (i + 0.5) / 4000, rho = baseline().sample(albedo, u);
      REQUIRE(rho > before);
      REQUIRE(baseline().cdf(albedo, rho) == Approx(u).margin(1e-10));
      before = rho;
    }
    // The density is the derivative of its integral, and positive everywhere.
    for (double x = -30; x < 40; x += 0.37) {
      const double rho = std::exp2(x), h = 1e-5 * rho;
      const double slope = (baseline().cdf(albedo, rho + h) - baseline().cdf(albedo, rho - h)) / (2 * h);
      REQUIRE(baseline().pdf(albedo, rho) > 0);
      REQUIRE(baseline().pdf(albedo, rho) == Approx(slope).epsilon(1e-3).margin(1e-10 / rho));
    }
    CHECK(std::isfinite(baseline().sample(albedo, 0x1.fffffffffffffp-1)));
    CHECK(baseline().sample(albedo, 0) >= 0);
  }
}

TEST_CASE("sampled distances follow the density (chi-square, significance 1e-4)") {
  for (const double albedo : albedos) {
    const int bins = 50, samples = 100000;
    std::vector<double> edges{0};
    for (int i = 1; i < bins; ++i)
      edges.push_back(baseline().sample(albedo, static_cast<double>(i) / bins) * 1.01);
    std::vector<double> counts(bins);
    Rng rng(5);
    for (int i = 0; i < samples; ++i) {
      const double rho = baseline().sample(albedo, rng.uniform());
      counts[static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), rho) - edges.begin() -
                                      1)] += 1;
    }
    double statistic = 0;
    for (std::size_t i = 0; i < bins; ++i) {
      // Integrated from the density, not from the distribution: Simpson's rule; the last bin is the rest.
      double share = 1;
      if (i + 1 < bins) {
        share = 0;
        const int parts = 400;
        const double width = edges[i + 1] - edges[i];
        for (int k = 0; k <= parts; ++k)
          share += (k == 0 || k == parts ? 1
                    : k % 2 == 1         ? 4
                                         : 2) *
                   baseline().pdf(albedo, std::max(1e-9, edges[i] + width * k / parts)) * width / (3 * parts);
      } else {
        share = 1 - baseline().cdf(albedo, edges[i]);
      }
      const double difference = counts[i] - samples * share;
      statistic += difference * difference / (samples * share);
    }
    CHECK(chi_square_p_value(statistic, bins - 1) > 1e-4);
  }
}

TEST_CASE("the sampled density is near the profile, so weights are bounded") {
  for (const double albedo : {0.3, 0.9, 0.99, 0.9999})
    for (double u = 0.0005; u < 1; u += 0.001) {
      const double rho = baseline().sample(albedo, u);
      const double weight = 2 * pi * rho * baseline().evaluate(albedo, rho) / baseline().reflectance(albedo) /
                            baseline().pdf(albedo, rho);
      REQUIRE(weight < 1.1);
    }
}
