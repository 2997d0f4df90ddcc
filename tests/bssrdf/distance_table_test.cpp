#include "bssrdf/distance_table.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "core/statistics.h"
#include "support/analytic_profile.h"

using namespace alabaster;

namespace {

const std::vector<double> albedos{0, 0.2, 0.5, 0.9, 0.99, 0.9999, 1};

}  // namespace

TEST_CASE("distances are drawn from the density that pdf() states", "[bssrdf]") {
  const DistanceTable table{AnalyticProfile()};
  constexpr int cells = 40, count = 20000;
  for (const double albedo : albedos) {
    const int level = DistanceTable::level(albedo);
    // Cells at log-spaced distances; expectations by quadrature of pdf(), not through cdf().
    std::vector<double> expected(cells + 2), observed(cells + 2);
    const auto edge = [](int k) { return std::exp2(-9 + 0.37 * k); };
    double inside = 0;
    for (int k = 0; k < cells; ++k) {
      constexpr int steps = 4000;
      const double width = (edge(k + 1) - edge(k)) / steps;
      double sum = 0;
      for (int i = 0; i < steps; ++i) sum += width * table.pdf(level, edge(k) + (i + 0.5) * width);
      expected[static_cast<std::size_t>(k + 1)] = sum;
      inside += sum;
    }
    expected[0] = table.pdf(level, 0.5 * edge(0)) * edge(0);
    expected.back() = 1 - inside - expected[0];
    REQUIRE(expected.back() > -1e-5);
    Rng rng(7, static_cast<uint64_t>(level));
    for (int i = 0; i < count; ++i) {
      const double rho = table.sample(level, rng.uniform());
      int k = 0;
      while (k <= cells && rho >= edge(k)) ++k;
      observed[static_cast<std::size_t>(k)] += 1;
    }
    // Neighbours are pooled until each cell expects ten.
    std::vector<double> pooled_expected{0}, pooled_observed{0};
    for (std::size_t k = 0; k < expected.size(); ++k) {
      pooled_expected.back() += expected[k] * count;
      pooled_observed.back() += observed[k];
      if (pooled_expected.back() < 10) continue;
      pooled_expected.push_back(0);
      pooled_observed.push_back(0);
    }
    const std::size_t last = pooled_expected.size() - 1;
    pooled_expected[last - 1] += pooled_expected[last];
    pooled_observed[last - 1] += pooled_observed[last];
    double statistic = 0;
    for (std::size_t k = 0; k < last; ++k)
      statistic += std::pow(pooled_observed[k] - pooled_expected[k], 2) / pooled_expected[k];
    const auto degrees = static_cast<double>(last - 1);
    CAPTURE(albedo, statistic, degrees);
    CHECK(chi_square_p_value(statistic, degrees) > sidak(0.01, static_cast<double>(albedos.size())));
  }
}

TEST_CASE("the distance table has no gap and no end", "[bssrdf]") {
  const DistanceTable table{AnalyticProfile()};
  for (int level = 0; level < DistanceTable::level_count; ++level) {
    double last = -1;
    for (int i = 0; i < 1000; ++i) {
      const double u = (i + 0.5) / 1000, rho = table.sample(level, u);
      CHECK(rho >= last);
      CHECK(table.cdf(level, rho) == Approx(u).margin(1e-12));
      last = rho;
    }
    // Far out, where what is left counts, not u itself.
    for (const double left : {1e-4, 1e-5, 1e-6, 1e-7, 1e-9}) {
      const double rho = table.sample(level, 1 - left);
      CHECK(1 - table.cdf(level, rho) == Approx(left).epsilon(1e-5));
    }
    for (const double rho : {0.0, 1e-300, 1e-12, 1e-3, 1.0, 1e3, 1e5, 1e9}) CHECK(table.pdf(level, rho) > 0);
    CHECK(std::isfinite(table.sample(level, 1 - 0x1p-53)));
  }
}

TEST_CASE("the distance table follows the profile", "[bssrdf]") {
  const AnalyticProfile profile;
  const DistanceTable table{profile};
  for (const double s : {0.25, 0.5, 0.75, 0.9375}) {  // quarter roots that levels stand at
    const double albedo = 1 - std::pow(s, 4);
    const int level = DistanceTable::level(albedo - 1e-9);
    for (double rho = 1e-3; rho < 20; rho *= 1.21) {
      const double wanted = profile.pdf(albedo, rho);
      if (wanted < 0.01) continue;  // the spread part counts there
      CAPTURE(albedo, rho);
      CHECK(table.pdf(level, rho) == Approx(wanted).epsilon(0.15));
    }
  }
}
