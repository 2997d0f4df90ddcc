#include "optics/profile_fit.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/rng.h"
#include "core/statistics.h"
#include "optics/bake.h"
#include "optics/half_space_walk.h"

using namespace alabaster;

namespace {

const ExponentialMixture example{{{0.3, 0.2}, {0.5, 1.1}, {0.2, 6.0}}};

FitData exact_data(const ExponentialMixture& mixture) {
  std::vector<double> log_density;
  for (int bin = 1; bin <= RadialBins::inner; ++bin)
    log_density.push_back(std::log(mixture.density(RadialBins::centre(bin)) + 1e-300));
  return fit_data(log_density, mixture.total(), 0.01, 40);
}

}  // namespace

TEST_CASE("a mixture's energy is the integral of its density") {
  CHECK(example.total() == Approx(1));
  CHECK(example.energy(0, 1e9) == Approx(1));
  const int steps = 100000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) sum += example.density(0.5 + 2.5 * (i + 0.5) / steps) * 2.5 / steps;
  CHECK(example.energy(0.5, 3) == Approx(sum).epsilon(1e-8));
}

TEST_CASE("mixture samples follow the density (chi-square, significance 1e-4)") {
  const int bins = 40, samples = 200000;
  std::vector<double> counts(bins);
  Rng rng(3);
  for (int i = 0; i < samples; ++i)
    counts[static_cast<std::size_t>(
        std::min(bins - 1.0, 4 * std::log1p(10 * example.sample(rng.uniform()))))] += 1;
  double statistic = 0, tested = 0;
  for (std::size_t i = 0; i < bins; ++i) {
    const auto edge = [](double k) { return std::expm1(k / 4) / 10; };
    const double expected = samples * example.energy(edge(static_cast<double>(i)),
                                                     i + 1 == bins ? 1e9 : edge(static_cast<double>(i) + 1));
    if (expected < 5) continue;
    statistic += (counts[i] - expected) * (counts[i] - expected) / expected;
    ++tested;
  }
  CHECK(chi_square_p_value(statistic, tested - 1) > 1e-4);
}

TEST_CASE("annealing finds a mixture again") {
  const FitData data = exact_data(example);
  AnnealingOptions options;
  options.components = 3;
  options.steps = 100000;
  const ExponentialMixture found = fit_by_annealing(data, options);
  const FitError error = fit_error(found, data);
  CHECK(error.mean < 0.005);
  CHECK(found.total() == Approx(data.total).epsilon(1e-12));
  // Fewer components than the data has cannot do it.
  options.components = 1;
  CHECK(fit_error(fit_by_annealing(data, options), data).mean > 0.1);
}

TEST_CASE("least squares at the true rates returns the true weights, and never a negative one") {
  const ExponentialMixture truth{{{0.3, 0.25}, {0.0, 1.0}, {0.7, 4.0}}};
  const FitData data = exact_data(truth);
  const ExponentialMixture found = fit_by_least_squares(data, 3, 0.25, 4);
  // The bins' energies are taken from densities at their centres, good to 1e-4.
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(found.components[k].weight == Approx(truth.components[k].weight).margin(2e-3));
  for (const ExponentialMixture::Component& c : fit_by_least_squares(data, 20, 0.05, 50).components)
    CHECK(c.weight >= 0);
}

TEST_CASE("five exponentials fit the simulated profile better than two, and L2 misses the tail") {
  const PathTally tally = half_space_tally({{0.3, 1.5}, 8 * photons_per_chunk, 5, false});
  const double albedo = 0.5, length = diffusion_length(albedo, 0.3);
  std::vector<Estimate> energy = radial_energy_over_albedo(tally, albedo);
  const FitData data =
      fit_data(energy, tally.reflectance_over_albedo(albedo).value, 0.01 * length, 10 * length, 0.05);
  REQUIRE(data.bins.size() > 20);
  AnnealingOptions options;
  const double five = fit_error(fit_by_annealing(data, options), data).mean;
  options.objective = FitObjective::l2;
  const double l2 = fit_error(fit_by_annealing(data, options), data).largest;
  options = {};
  options.components = 2;
  const ExponentialMixture two = fit_by_annealing(data, options);
  INFO("five " << five << ", two " << fit_error(two, data).mean << ", largest by L2 " << l2);
  CHECK(five < fit_error(two, data).mean);
  CHECK(l2 > fit_error(fit_by_annealing(data, {}), data).largest);
}
