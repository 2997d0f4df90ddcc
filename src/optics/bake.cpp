#include "optics/bake.h"

#include <fmt/format.h>

#include <cmath>

#include "optics/photon_lanes.h"
#include "optics/profile_fit.h"
#include "optics/radial_density.h"

namespace alabaster {

namespace {

// Energy that leaves after the last order tallied, per unit of entered energy and albedo: a share `inside` is
// still there after N orders and leaves as n^(-3/2), the law of a walk's return to its boundary.
double truncated_energy_over_albedo(double inside, double albedo) {
  const double x = (1 - albedo) * static_cast<double>(OrderGroups::limit);
  return x > 700 ? 0 : inside * (std::exp(-x) - std::sqrt(pi * x) * std::erfc(std::sqrt(x)));
}

// Paths of N orders reach about sqrt(N / (1 - g)) mean free paths; beyond a part of that bins lack energy,
// unless absorption ends the paths first.
double trusted_radius(double albedo, double g) {
  const double orders_missing = (1 - albedo) * static_cast<double>(OrderGroups::limit);
  return 0.33 * std::sqrt(static_cast<double>(OrderGroups::limit) / (1 - g)) *
         (1 + 0.25 * orders_missing * orders_missing);
}

// Energy per radial bin and in total, per unit entered and per albedo.
struct RowEnergy {
  std::vector<Estimate> bins;
  Estimate total;
};

RowEnergy read_row(const PathTally& tally, const BakeOptions& options, double albedo) {
  if (options.view == TableView::all)
    return {radial_energy_over_albedo(tally, albedo), tally.reflectance_over_albedo(albedo)};
  RowEnergy row{normal_view_energy_over_albedo(tally, albedo, normal_view_score(options.medium)), {}};
  double variance = 0;
  for (const Estimate& e : row.bins) {
    row.total.value += e.value;
    variance += e.standard_error * e.standard_error;
  }
  row.total.standard_error = std::sqrt(variance);
  return row;
}

// Five exponentials for every row, each started from the row before, so that parameters move smoothly with
// alpha. The first row, single scattering alone, is annealed from hot.
void add_mixtures(TableData& table, const std::vector<std::vector<double>>& log_density) {
  table.mixture.resize(static_cast<std::size_t>(AlbedoRows::count) * TableData::mixture_size);
  ExponentialMixture mixture;
  for (int row = 0; row < AlbedoRows::count; ++row) {
    const auto r = static_cast<std::size_t>(row);
    const double length = diffusion_length(AlbedoRows::albedo(row), table.g);
    const FitData data = fit_data(log_density[r], table.reflectance_over_albedo[r],
                                  std::min(0.01 * length, 0.05), std::min(10 * length, 2000.0));
    AnnealingOptions options;
    options.components = TableData::mixture_size;
    options.steps = 200000;
    if (!mixture.components.empty()) {
      options.steps = 10000;
      options.start_temperature = 0.01;
      options.step_size = 0.05;
    }
    mixture = fit_by_annealing(data, options, mixture);
    table.mixture_error += fit_error(mixture, data).mean / AlbedoRows::count;
    for (std::size_t k = 0; k < TableData::mixture_size; ++k)
      table.mixture[r * TableData::mixture_size + k] = {mixture.components[k].weight,
                                                        mixture.components[k].rate};
  }
}

}  // namespace

TableData tabulate(const PathTally& tally, const BakeOptions& options) {
  TableData table;
  table.view = options.view;
  table.g = options.medium.g;
  table.eta = options.medium.eta;
  table.photons = tally.photons();
  table.collisions = tally.collisions();
  table.seed = options.seed;
  table.truncated = tally.truncated();
  table.provenance =
      fmt::format("half-space walk, uniform radiance in, {} out; {} photons, {:.3g} collisions, seed {}",
                  options.view == TableView::all ? "all directions" : "the normal", table.photons,
                  static_cast<double>(table.collisions), table.seed);
  std::vector<std::vector<double>> log_density;
  for (int row = 0; row < AlbedoRows::count; ++row) {
    const double albedo = AlbedoRows::albedo(row);
    const RowEnergy energy = read_row(tally, options, albedo);
    const double over_albedo =
        row == 0 ? 1.0 : energy.total.value + truncated_energy_over_albedo(table.truncated, albedo);
    table.reflectance_over_albedo.push_back(over_albedo);
    table.reflectance_standard_error.push_back(row == 0 ? 0.0 : energy.total.standard_error);
    const double decay = std::sqrt(3 * (1 - albedo) * (1 - options.medium.g * albedo));
    std::vector<double> density =
        smooth_log_density(energy.bins, decay, trusted_radius(albedo, options.medium.g));
    const double shift = std::log(over_albedo / integrate_log_density(density));
    for (double& value : density)
      table.log2_density.push_back(static_cast<float>((value += shift) / 0.69314718055994530942));
    log_density.push_back(std::move(density));
  }
  add_mixtures(table, log_density);
  return table;
}

TableData bake_table(const BakeOptions& options, const std::function<void(double)>& progress) {
  return tabulate(
      half_space_tally({options.medium, options.photons, options.seed, options.view == TableView::normal},
                       progress),
      options);
}

}  // namespace alabaster
