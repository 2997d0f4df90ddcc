#include "bssrdf/distance_table.h"

#include <algorithm>
#include <cmath>

namespace alabaster {
namespace {

/// Of the mass, spread as 1/(1 + rho)^2, so that the density never underflows.
constexpr double spread_share = 1e-3;

}  // namespace

std::vector<double> DistanceTable::bin_masses(const ProfileTable& profile, double albedo) {
  std::vector<double> mass(bin_count + 1);  // the last is the tail
  double total = 0;
  for (int bin = 0; bin < bin_count; ++bin) {
    const double low = edge(bin), width = edge(bin + 1) - low;
    // Two-point Gauss-Legendre.
    const double density = 0.5 * (profile.pdf(albedo, low + 0.21132486540518712 * width) +
                                  profile.pdf(albedo, low + 0.78867513459481288 * width));
    total += mass[static_cast<std::size_t>(bin)] = density * width;
  }
  mass.back() = std::max(0.0, 1 - total);
  total += mass.back();
  for (int bin = 0; bin <= bin_count; ++bin) {
    double& m = mass[static_cast<std::size_t>(bin)];
    const double beyond = bin < bin_count ? 1 / (1 + edge(bin + 1)) : 0;
    m = (1 - spread_share) * m / total + spread_share * (1 / (1 + edge(bin)) - beyond);
  }
  return mass;
}

DistanceTable::DistanceTable(const ProfileTable& profile) {
  density_.reserve(row_begin(level_count));
  cumulative_.reserve(row_begin(level_count));
  for (int level = 0; level < level_count; ++level) {
    const std::vector<double> mass = bin_masses(profile, std::max(albedo(level), 1e-6));
    double sum = 0;
    for (int bin = 0; bin <= bin_count; ++bin) {
      const double m = mass[static_cast<std::size_t>(bin)];
      // The tail's density is m * last / rho^2.
      density_.push_back(bin < bin_count ? m / (edge(bin + 1) - edge(bin)) : m * edge(bin_count));
      cumulative_.push_back(sum);
      sum += m;
    }
  }
}

double DistanceTable::albedo(int level) {
  const double s = static_cast<double>(level) / (level_count - 1);
  return 1 - s * s * s * s;
}

int DistanceTable::level(double albedo) {
  const double s = std::sqrt(std::sqrt(std::clamp(1 - albedo, 0.0, 1.0)));
  return static_cast<int>(s * (level_count - 1));
}

double DistanceTable::sample(int level, double u) const {
  const double* row = cumulative_.data() + row_begin(level);
  const auto bin = static_cast<int>(std::upper_bound(row, row + bin_count + 1, u) - row) - 1;
  const double density = density_[row_begin(level) + static_cast<std::size_t>(bin)];
  const double rest = u - row[bin];
  if (bin < bin_count) return std::min(edge(bin) + rest / density, edge(bin + 1));
  // P(rho > x) = density / x in the tail.
  return density / std::max(1 - u, 1e-12);
}

double DistanceTable::cdf(int level, double rho) const {
  const int bin = bin_of(rho);
  const std::size_t index = row_begin(level) + static_cast<std::size_t>(bin);
  if (bin < bin_count) return cumulative_[index] + density_[index] * (rho - edge(bin));
  return 1 - density_[index] / rho;
}

}  // namespace alabaster
