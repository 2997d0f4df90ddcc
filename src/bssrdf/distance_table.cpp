#include "bssrdf/distance_table.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace alabaster {
namespace {

// Bin 0 is [0, 2^first_octave), where the density is flat: R ~ 1/rho. Then 16 bins per octave, as the four
// leading bits of the mantissa count them, up to 2^last_octave; the rest falls as 1/rho^2.
constexpr int first_octave = -10, last_octave = 14, bins_per_octave = 16;
constexpr int bin_count = (last_octave - first_octave) * bins_per_octave + 1;
constexpr int mantissa_shift = 52 - 4;
constexpr int64_t first_code = int64_t{1023 + first_octave} * bins_per_octave;

/// Of the mass, spread as 1/(1 + rho)^2, so that the density never underflows.
constexpr double spread_share = 1e-3;

/// Where a level's bins begin in the tables.
std::size_t row_of(int level) {
  return static_cast<std::size_t>(level) * (bin_count + 1);
}

int bin_of(double rho) {
  const auto code = static_cast<int64_t>(std::bit_cast<uint64_t>(rho) >> mantissa_shift) - first_code + 1;
  return static_cast<int>(std::clamp<int64_t>(code, 0, bin_count));
}

double edge(int bin) {
  if (bin == 0) return 0;
  return std::bit_cast<double>(static_cast<uint64_t>(first_code + bin - 1) << mantissa_shift);
}

std::vector<double> bin_masses(const ProfileTable& profile, double albedo) {
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

}  // namespace

DistanceTable::DistanceTable(const ProfileTable& profile) {
  density_.reserve(row_of(level_count));
  cumulative_.reserve(row_of(level_count));
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
  const double* row = cumulative_.data() + row_of(level);
  const auto bin = static_cast<int>(std::upper_bound(row, row + bin_count + 1, u) - row) - 1;
  const double density = density_[row_of(level) + static_cast<std::size_t>(bin)];
  const double rest = u - row[bin];
  if (bin < bin_count) return std::min(edge(bin) + rest / density, edge(bin + 1));
  // P(rho > x) = density / x in the tail.
  return density / std::max(1 - u, 1e-12);
}

double DistanceTable::pdf(int level, double rho) const {
  const int bin = bin_of(rho);
  const double density = density_[row_of(level) + static_cast<std::size_t>(bin)];
  return bin < bin_count ? density : density / (rho * rho);
}

double DistanceTable::cdf(int level, double rho) const {
  const int bin = bin_of(rho);
  const std::size_t index = row_of(level) + static_cast<std::size_t>(bin);
  if (bin < bin_count) return cumulative_[index] + density_[index] * (rho - edge(bin));
  return 1 - density_[index] / rho;
}

}  // namespace alabaster
