#include "optics/radial_density.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cassert>
#include <cmath>

namespace alabaster {

namespace {

constexpr double log_step = 0.69314718055994530942 / RadialBins::per_octave;

// Minimises sum w (y - x)^2 + stiffness sum (second differences of x)^2. As rho -> 0 the density tends to a
// constant: there slopes d x / d log rho are held to the order of 3 rho.
Eigen::VectorXd whittaker(const Eigen::VectorXd& y, const Eigen::VectorXd& weight, double stiffness) {
  const Eigen::Index n = y.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < n; ++i) entries.emplace_back(i, i, weight[i] + 1e-9);
  const double stencil[3] = {1, -2, 1};
  for (Eigen::Index i = 0; i + 2 < n; ++i)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) entries.emplace_back(i + a, i + b, stiffness * stencil[a] * stencil[b]);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const double typical = 3 * RadialBins::edge(static_cast<int>(i) + 2) * log_step,
                 flatness = 1 / (typical * typical);
    entries.emplace_back(i, i, flatness);
    entries.emplace_back(i + 1, i + 1, flatness);
    entries.emplace_back(i, i + 1, -flatness);
    entries.emplace_back(i + 1, i, -flatness);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  return solver.solve(weight.cwiseProduct(y));
}

// Integral of a power law through two points, step = log(rho_1 / rho_0), in units of rho_0 f_0.
double power_law_integral(double slope, double step) {
  const double exponent = (slope + 1) * step;
  return std::abs(exponent) < 1e-9 ? step : std::expm1(exponent) / (slope + 1);
}

// Mean of the density over bin `j`, over its value at the centre, given the slopes d log f / d log rho on
// both sides.
double mean_over_centre(double slope_below, double slope_above) {
  const double half = 0.5 * log_step;
  const double steepest = -1000;  // e^20 within a bin: far below anything measured
  slope_below = std::max(slope_below, steepest);
  slope_above = std::max(slope_above, steepest);
  const double below = -power_law_integral(slope_below, -half), above = power_law_integral(slope_above, half);
  return (below + above) / (2 * std::sinh(half));
}

}  // namespace

std::vector<double> smooth_log_density(const std::vector<Estimate>& energy, double decay,
                                       double trusted_radius) {
  assert(energy.size() == RadialBins::count);
  const Eigen::Index n = RadialBins::inner;
  Eigen::VectorXd measured(n), weight(n), tilt(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const int bin = static_cast<int>(j) + 1;
    const Estimate& e = energy[static_cast<std::size_t>(bin)];
    const double rho = RadialBins::centre(bin);
    // Photons that would give this relative error; few of them make a biased logarithm, so they fade out.
    const bool measured_at_all = e.value > 1e-250 && e.standard_error > 0;
    const double significance = measured_at_all ? e.value / e.standard_error : 0;
    const double photons = significance * significance;
    const double fade = photons * photons / (photons * photons + 400);
    tilt[j] = decay * rho;
    measured[j] = measured_at_all ? std::log(e.value / RadialBins::width(bin)) + tilt[j] : 0;
    weight[j] = photons * fade / (1 + std::pow(rho / trusted_radius, 8));
  }
  // The second difference of log f is of the order of step^2.
  const double stiffness = 1 / (log_step * log_step * log_step * log_step);
  // A bin's mean is not the density at its centre where the profile bends or is steep: correct twice.
  Eigen::VectorXd target = measured, smooth;
  for (int pass = 0; pass < 3; ++pass) {
    smooth = whittaker(target, weight, stiffness) - tilt;
    if (pass == 2) break;
    for (Eigen::Index j = 1; j + 1 < n; ++j) {
      const double below = (smooth[j] - smooth[j - 1]) / log_step,
                   above = (smooth[j + 1] - smooth[j]) / log_step;
      target[j] = measured[j] - std::log(mean_over_centre(below, above));
    }
  }
  return {smooth.data(), smooth.data() + n};
}

double integrate_log_density(const std::vector<double>& log_density) {
  const std::size_t last = log_density.size() - 1;
  double sum = RadialBins::centre(1) * std::exp(log_density[0]);
  for (std::size_t j = 0; j < last; ++j) {
    const double slope = (log_density[j + 1] - log_density[j]) / log_step;
    sum += RadialBins::centre(static_cast<int>(j) + 1) * std::exp(log_density[j]) *
           power_law_integral(slope, log_step);
  }
  const double slope = (log_density[last] - log_density[last - 1]) / log_step;
  if (slope < -1)
    sum += RadialBins::centre(static_cast<int>(last) + 1) * std::exp(log_density[last]) / (-1 - slope);
  return sum;
}

}  // namespace alabaster
