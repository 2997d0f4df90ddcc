#pragma once

#include <cstdint>
#include <vector>

#include "optics/exponential_mixture.h"
#include "optics/path_tally.h"

namespace alabaster {

/// What is fitted: energies of annuli, per unit of entered energy, and the total A they belong to.
struct FitData {
  struct Bin {
    double from, to;  // rho
    double energy;
    double relative_error;  // standard error / energy
  };
  std::vector<Bin> bins;
  double total = 0;
};

/// Radial bins that make one bin of the fit: four to the octave.
inline constexpr int fit_bin = 4;

/// The bins within [nearest, farthest] whose relative standard error is at most `worst_error`.
FitData fit_data(const std::vector<Estimate>& radial_energy, double total, double nearest, double farthest,
                 double worst_error);

/// The same bins from a smooth density at the centres of the inner radial bins, all taken as exact.
FitData fit_data(const std::vector<double>& log_density, double total, double nearest, double farthest);

/// 1 / sqrt(3 (1 - alpha) (1 - g alpha)): the diffusion length, mean free paths. Infinite at alpha = 1.
double diffusion_length(double albedo, double g);

enum class FitObjective {
  ratio,  // mean over bins of max(model/data, data/model) - 1: [EK17]'s, fits the tail as well as the centre
  l2      // sum of squared differences of the density over the plane
};

struct AnnealingOptions {
  int components = 5;
  FitObjective objective = FitObjective::ratio;
  int steps = 40000;
  uint64_t seed = 1;
  double start_temperature = 0.1;  // relative to the objective
  double step_size = 0.5;          // of the first moves, in logarithms
};

/// Simulated annealing over the logarithms of rates and weights, the weights kept at their sum `data.total`.
/// From `start` when it is not empty (then a low start_temperature is wise), else from log-spaced rates.
ExponentialMixture fit_by_annealing(const FitData& data, const AnnealingOptions& options,
                                    const ExponentialMixture& start = {});

/// Fixed rates in geometric progression from `slowest` to `fastest`; weights by non-negative least squares on
/// the relative error (Lawson & Hanson 1974), with the sum of weights held to data.total by one more, heavy
/// row. Convex: one solution.
ExponentialMixture fit_by_least_squares(const FitData& data, int components, double slowest, double fastest);

struct FitError {
  double mean = 0, largest = 0;  // of |model/data - 1| over the bins
  double total = 0;              // of the sum of weights, relative to A
};
FitError fit_error(const ExponentialMixture& mixture, const FitData& data);

}  // namespace alabaster
