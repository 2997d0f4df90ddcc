#pragma once

#include <vector>

#include "optics/path_tally.h"

namespace alabaster {

/// Natural logarithm of a radial density at the centres of the inner radial bins (RadialBins::inner values),
/// smoothed from bin energies: f(rho) = 2 pi rho R, per unit rho.
///
/// Penalised least squares on log f + decay rho over log rho (Whittaker 1923 with second differences): what
/// is not measured continues as a power law times exp(-decay rho). Bins count by their own statistics.
/// `trusted_radius` is the distance beyond which the energies are known to be incomplete.
std::vector<double> smooth_log_density(const std::vector<Estimate>& energy, double decay,
                                       double trusted_radius);

/// Integral over (0, inf) of the density whose logarithm is linear in log rho between bin centres, constant
/// below the first centre and of the last slope (below -1) beyond the last centre.
double integrate_log_density(const std::vector<double>& log_density);

}  // namespace alabaster
