#include "optics/bake.h"

#include <fmt/format.h>

#include <cmath>

#include "optics/radial_density.h"

namespace alabaster {

namespace {

// Energy that leaves after the last order tallied, per unit of entered energy and albedo: a share `inside` is
// still there after N orders and leaves as n^(-3/2), the law of a walk's return to its boundary.
double truncated_energy_over_albedo(double inside, double albedo) {
  const double x = (1 - albedo) * static_cast<double>(OrderGroups::limit);
  return x > 700 ? 0 : inside * (std::exp(-x) - std::sqrt(pi * x) * std::erfc(std::sqrt(x)));
}

// Paths of the orders tallied reach about sqrt(N) mean free paths; beyond half of that bins lack energy,
// unless absorption ends the paths first.
double trusted_radius(double albedo) {
  const double orders_missing = (1 - albedo) * static_cast<double>(OrderGroups::limit);
  return 400 * (1 + 0.25 * orders_missing * orders_missing);
}

}  // namespace

TableData tabulate(const PathTally& tally, const BakeOptions& options) {
  TableData table;
  table.g = options.medium.g;
  table.eta = options.medium.eta;
  table.photons = tally.photons();
  table.collisions = tally.collisions();
  table.seed = options.seed;
  table.truncated = tally.truncated();
  table.provenance =
      fmt::format("half-space walk, uniform radiance in, all directions out; {} photons, {:.3g} collisions",
                  table.photons, static_cast<double>(table.collisions));
  for (int row = 0; row < AlbedoRows::count; ++row) {
    const double albedo = AlbedoRows::albedo(row);
    const Estimate measured = tally.reflectance_over_albedo(albedo);
    const double over_albedo = measured.value + truncated_energy_over_albedo(table.truncated, albedo);
    table.reflectance_over_albedo.push_back(row == 0 ? 1.0 : over_albedo);
    table.reflectance_standard_error.push_back(row == 0 ? 0.0 : measured.standard_error);
    const double decay = std::sqrt(3 * (1 - albedo) * (1 - options.medium.g * albedo));
    const std::vector<double> density =
        smooth_log_density(radial_energy_over_albedo(tally, albedo), decay, trusted_radius(albedo));
    const double shift = std::log(over_albedo / integrate_log_density(density));
    for (const double value : density)
      table.log2_density.push_back(static_cast<float>((value + shift) / 0.69314718055994530942));
  }
  return table;
}

TableData bake_table(const BakeOptions& options, const std::function<void(double)>& progress) {
  return tabulate(half_space_tally({options.medium, options.photons, options.seed}, progress), options);
}

}  // namespace alabaster
