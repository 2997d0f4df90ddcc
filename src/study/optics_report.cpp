#include "study/optics_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/vec.h"
#include "optics/mixture_profile.h"
#include "optics/profile_fit.h"
#include "optics/tabulated_profile.h"
#include "report/chart.h"

namespace alabaster {

namespace fs = std::filesystem;

namespace {

constexpr double worst_bin_error = 0.02;
// An albedo with fewer bins than that is left out.
constexpr std::size_t fewest_bins = 12;
using Density = std::function<double(double)>;  // 2 pi rho R at rho

const std::vector<double>& study_albedos() {
  // 0.05 to 0.99999, near-equidistant in sqrt(1 - alpha).
  static const std::vector<double> albedos = [] {
    std::vector<double> all;
    const double first = std::sqrt(1 - 0.05), last = std::sqrt(1 - 0.99999);
    for (int i = 0; i <= 32; ++i) all.push_back(1 - std::pow(first + (last - first) * i / 32, 2));
    for (const double albedo : {0.999, 0.9999}) all.push_back(albedo);
    std::sort(all.begin(), all.end());
    return all;
  }();
  return albedos;
}

struct Target {
  double albedo, length, total;
  FitData data;
  std::size_t bins_in_range;
};

Target target_at(const PathTally& simulation, double albedo, double g) {
  std::vector<Estimate> energy = radial_energy_over_albedo(simulation, albedo);
  for (Estimate& e : energy) e.value *= albedo, e.standard_error *= albedo;
  const double length = diffusion_length(albedo, g),
               total = albedo * simulation.reflectance_over_albedo(albedo).value;
  return {albedo, length, total, fit_data(energy, total, 0.01 * length, 10 * length, worst_bin_error),
          fit_data(energy, total, 0.01 * length, 10 * length, HUGE_VAL).bins.size()};
}

double bin_energy(const Density& density, double from, double to) {
  const int parts = 8;
  double sum = 0;
  for (int i = 0; i < parts; ++i) sum += density(from + (to - from) * (i + 0.5) / parts);
  return sum * (to - from) / parts;
}

// Radiosity at distance r from the centre of a uniformly lit disk of radius 1.
double disk_image(const Density& density, double r) {
  const int steps = 400;
  const double low = std::max(1e-4, std::abs(r - 1)), high = r + 1;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double rho = low + (high - low) * (i + 0.5) / steps;
    const double cosine = (r * r + rho * rho - 1) / (2 * r * rho);
    sum += density(rho) * std::acos(std::clamp(cosine, -1.0, 1.0)) / pi * (high - low) / steps;
  }
  if (r < 1) {
    for (int i = 0; i < steps; ++i) sum += density((1 - r) * (i + 0.5) / steps) * (1 - r) / steps;
  }
  return sum;
}

struct Measured {
  double mean = 0, largest = 0, total_error = 0, image_error = 0, seconds = 0;
};

Measured measure(const Density& density, double total, const Target& target, const Density& truth) {
  Measured result;
  for (const FitData::Bin& bin : target.data.bins) {
    const double relative = std::abs(bin_energy(density, bin.from, bin.to) / bin.energy - 1);
    result.mean += relative / static_cast<double>(target.data.bins.size());
    result.largest = std::max(result.largest, relative);
  }
  result.total_error = total / target.total - 1;
  for (int i = 0; i < 20; ++i) {
    const double r = 0.125 + 0.25 * i;
    result.image_error += std::abs(std::log(disk_image(density, r) / disk_image(truth, r))) / 20;
  }
  return result;
}

struct Fit {
  Density density;
  double total = 0, seconds = 0;
};

using Method = std::function<Fit(const Target&)>;

Fit timed(const std::function<ExponentialMixture()>& make) {
  const double start = cpu_seconds();
  const ExponentialMixture mixture = make();
  return {[mixture](double rho) { return mixture.density(rho); }, mixture.total(), cpu_seconds() - start};
}

Method annealing(int components, FitObjective objective) {
  return [=](const Target& target) {
    AnnealingOptions options;
    options.components = components;
    options.objective = objective;
    return timed([&] { return fit_by_annealing(target.data, options); });
  };
}

Method least_squares(int components) {
  return [=](const Target& target) {
    return timed([&] { return fit_by_least_squares(target.data, components, 0.8 / target.length, 20); });
  };
}

Method profile_method(const ProfileTable& profile) {
  return [&profile](const Target& target) {
    const double albedo = target.albedo;
    return Fit{[&profile, albedo](double rho) { return 2 * pi * rho * profile.evaluate(albedo, rho); },
               profile.reflectance(albedo), 0};
  };
}

// Root mean square of the second differences of ln(fit / table) from albedo to albedo: 0 for a fit as smooth
// in alpha as the table.
double roughness(const std::vector<Density>& fits, const std::vector<Density>& table,
                 const std::vector<Target>& targets) {
  double sum = 0;
  int count = 0;
  for (const double in_lengths : {0.1, 1.0, 4.0})
    for (std::size_t i = 1; i + 1 < fits.size(); ++i) {
      const auto log_ratio = [&](std::size_t k) {
        const double rho = in_lengths * targets[k].length;
        return std::log(fits[k](rho) / table[k](rho));
      };
      const double second = log_ratio(i - 1) - 2 * log_ratio(i) + log_ratio(i + 1);
      sum += second * second;
      ++count;
    }
  return std::sqrt(sum / count);
}

void write_lobe(const PathTally& simulation, double eta, const fs::path& folder) {
  std::string csv = "alpha,cosine,ratio,standard_error\n";
  Chart chart;
  chart.title = "outgoing light over the Fresnel-weighted cosine";
  chart.x_label = "outside cosine to the normal";
  chart.y_label = "ratio";
  for (const double albedo : {0.5, 0.9, 0.99}) {
    ChartSeries series;
    series.name = fmt::format("alpha = {}", albedo);
    const std::vector<Estimate> lobe = exit_lobe_ratio(simulation, albedo, eta);
    for (std::size_t bin = 0; bin < PathTally::cosine_bins; ++bin) {
      series.x.push_back((static_cast<double>(bin) + 0.5) / PathTally::cosine_bins);
      series.y.push_back(lobe[bin].value);
      csv += fmt::format("{},{:.6f},{:.4f},{:.4f}\n", albedo, series.x.back(), lobe[bin].value,
                         lobe[bin].standard_error);
    }
    chart.series.push_back(std::move(series));
  }
  write_text_atomically(folder / "lobe.csv", csv);
  write_chart_svg(folder / "lobe.svg", chart);
}

void write_profiles(const PathTally& simulation, const Method& table, const Method& mixture, double g,
                    const fs::path& folder) {
  Chart chart;
  chart.title = "rho R(rho)";
  chart.x_label = "optical distance rho";
  chart.y_label = "rho R";
  chart.log_x = chart.log_y = true;
  for (const double albedo : {0.3, 0.9, 0.99, 0.9999}) {
    const Target target = target_at(simulation, albedo, g);
    ChartSeries points, lines, five;
    if (target.data.bins.empty()) continue;
    points.name = fmt::format("alpha = {}: simulation", albedo);
    points.line = false;
    lines.name = "table";
    five.name = "five exponentials";
    lines.points = five.points = false;
    for (const FitData::Bin& bin : target.data.bins) {
      points.x.push_back(std::sqrt(bin.from * bin.to));
      points.y.push_back(bin.energy / (bin.to - bin.from) / (2 * pi));
    }
    const Density exact = table(target).density, mixed = mixture(target).density;
    for (double x = std::log(0.01 * target.length); x < std::log(10 * target.length); x += 0.1) {
      const double rho = std::exp(x);
      lines.x.push_back(rho), lines.y.push_back(exact(rho) / (2 * pi));
      five.x.push_back(rho), five.y.push_back(mixed(rho) / (2 * pi));
    }
    for (ChartSeries* series : {&points, &lines, &five}) chart.series.push_back(std::move(*series));
  }
  write_chart_svg(folder / "profiles.svg", chart);
}

void write_fit_by_distance(const Target& target, const std::map<std::string, Method>& methods,
                           const fs::path& file) {
  Chart chart;
  chart.title = fmt::format("error of the profile at alpha = {} (beyond 30 %: left out)", target.albedo);
  chart.x_label = "rho / diffusion length";
  chart.y_label = "error, %";
  chart.log_x = true;
  for (const char* name : {"annealing 5", "annealing 2", "annealing 5 L2", "table"}) {
    const Density density = methods.at(name)(target).density;
    ChartSeries series;
    series.name = name;
    for (const FitData::Bin& bin : target.data.bins) {
      const double error = 100 * (bin_energy(density, bin.from, bin.to) / bin.energy - 1);
      if (std::abs(error) > 30) continue;
      series.x.push_back(std::sqrt(bin.from * bin.to) / target.length);
      series.y.push_back(error);
    }
    chart.series.push_back(std::move(series));
  }
  write_chart_svg(file, chart);
}

}  // namespace

void write_optics_report(const PathTally& simulation, const TableData& data, const fs::path& folder) {
  const TabulatedProfile table(data);
  const MixtureProfile mixture(data);
  std::map<std::string, Method> methods{{"table", profile_method(table)},
                                        {"table's five exponentials", profile_method(mixture)},
                                        {"annealing 5", annealing(5, FitObjective::ratio)},
                                        {"annealing 2", annealing(2, FitObjective::ratio)},
                                        {"annealing 5 L2", annealing(5, FitObjective::l2)},
                                        {"least squares 5", least_squares(5)},
                                        {"least squares 12", least_squares(12)},
                                        {"least squares 24", least_squares(24)}};
  std::vector<Target> targets;
  std::vector<Density> truth;
  for (const double albedo : study_albedos()) {
    Target target = target_at(simulation, albedo, data.g);
    if (target.data.bins.size() < fewest_bins) continue;
    targets.push_back(std::move(target));
    truth.push_back(methods.at("table")(targets.back()).density);
  }
  if (targets.empty())
    throw InputError(folder.string(), "too few photons for a report; give --photons 500000 or more");
  std::string rows =
      "method,alpha,bins,bins_in_range,mean_error,largest_error,A_error,image_log_ratio,seconds\n";
  std::string summary =
      "method,mean_error,largest_error,largest_A_error,image_log_ratio,roughness,seconds_per_albedo\n";
  Chart chart;
  chart.title = "error of the profile";
  chart.x_label = "sqrt(1 - alpha)";
  chart.y_label = "mean relative error, %";
  chart.log_x = chart.log_y = true;
  for (const auto& [name, method] : methods) {
    Measured worst;
    std::vector<Density> fits;
    ChartSeries series;
    series.name = name;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const Target& target = targets[i];
      const Fit fit = method(target);
      fits.push_back(fit.density);
      const Measured m = measure(fit.density, fit.total, target, truth[i]);
      rows += fmt::format("{},{:.6g},{},{},{:.5f},{:.5f},{:.2e},{:.5f},{:.4f}\n", name, target.albedo,
                          target.data.bins.size(), target.bins_in_range, m.mean, m.largest, m.total_error,
                          m.image_error, fit.seconds);
      const auto n = static_cast<double>(targets.size());
      worst.mean += m.mean / n;
      worst.largest = std::max(worst.largest, m.largest);
      worst.total_error = std::max(worst.total_error, std::abs(m.total_error));
      worst.image_error += m.image_error / n;
      worst.seconds += fit.seconds / n;
      series.x.push_back(std::sqrt(1 - target.albedo));
      series.y.push_back(100 * m.mean);
    }
    chart.series.push_back(std::move(series));
    summary +=
        fmt::format("{},{:.5f},{:.5f},{:.2e},{:.5f},{:.5f},{:.4f}\n", name, worst.mean, worst.largest,
                    worst.total_error, worst.image_error, roughness(fits, truth, targets), worst.seconds);
  }
  write_text_atomically(folder / "fits.csv", rows);
  write_text_atomically(folder / "summary.csv", summary);
  write_chart_svg(folder / "fits.svg", chart);
  write_lobe(simulation, data.eta, folder);
  write_profiles(simulation, methods.at("table"), methods.at("table's five exponentials"), data.g, folder);
  for (const double albedo : {0.5, 0.9, 0.99}) {
    const Target target = target_at(simulation, albedo, data.g);
    if (target.data.bins.size() >= fewest_bins)
      write_fit_by_distance(target, methods, folder / fmt::format("fit_by_distance_{}.svg", albedo));
  }
}

}  // namespace alabaster
