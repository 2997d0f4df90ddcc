#include "optics/phase_function.h"

#include <catch2/catch.hpp>
#include <vector>

#include "core/rng.h"
#include "core/statistics.h"

using namespace alabaster;

TEST_CASE("Henyey-Greenstein: normalised, of mean cosine g") {
  for (const double g : {-0.95, -0.3, 0.0, 1e-9, 0.3, 0.75, 0.95}) {
    const int steps = 400000;
    double sum = 0, mean = 0;
    for (int i = 0; i < steps; ++i) {
      const double cosine = -1 + (i + 0.5) * 2 / steps;
      const double weight = henyey_greenstein(cosine, g) * 2 * pi * 2 / steps;
      sum += weight;
      mean += weight * cosine;
    }
    CHECK(sum == Approx(1).margin(1e-6));
    CHECK(mean == Approx(g).margin(1e-6));
  }
}

TEST_CASE("Henyey-Greenstein sampling is the exact inverse of its distribution") {
  for (const double g : {-0.99, -0.5, -1e-7, 0.0, 1e-12, 1e-4, 0.3, 0.9, 0.99}) {
    CHECK(sample_henyey_greenstein(0, g) == Approx(-1));
    CHECK(sample_henyey_greenstein(1, g) == Approx(1));
    for (double u = 0.01; u < 1; u += 0.01)
      CHECK(henyey_greenstein_cdf(sample_henyey_greenstein(u, g), g) == Approx(u).margin(1e-12));
  }
}

TEST_CASE("Henyey-Greenstein samples follow the density (chi-square, significance 1e-4)") {
  for (const double g : {-0.7, 0.0, 0.3, 0.9}) {
    const int bins = 40, samples = 200000;
    std::vector<double> counts(bins);
    Rng rng(11);
    for (int i = 0; i < samples; ++i) {
      const double cosine = sample_henyey_greenstein(rng.uniform(), g);
      counts[static_cast<std::size_t>(std::min(bins - 1.0, (cosine + 1) / 2 * bins))] += 1;
    }
    double statistic = 0;
    for (int bin = 0; bin < bins; ++bin) {
      // Simpson's rule over the bin.
      double share = 0;
      const int parts = 200;
      for (int i = 0; i <= parts; ++i)
        share += (i == 0 || i == parts ? 1
                  : i % 2 == 1         ? 4
                                       : 2) *
                 henyey_greenstein(-1 + (bin + static_cast<double>(i) / parts) * 2 / bins, g);
      const double expected = samples * share * 2 * pi * 2 / bins / (3 * parts);
      const double difference = counts[static_cast<std::size_t>(bin)] - expected;
      statistic += difference * difference / expected;
    }
    CHECK(chi_square_p_value(statistic, bins - 1) > 1e-4);
  }
}
