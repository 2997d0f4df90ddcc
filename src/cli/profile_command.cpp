#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/commands.h"
#include "cli/option_checks.h"
#include "core/cancellation.h"
#include "core/error.h"
#include "core/vec.h"
#include "optics/albedo_walk.h"
#include "optics/profile_fit.h"
#include "report/chart.h"

namespace alabaster {

namespace {

struct ProfileArguments {
  AlbedoWalkOptions walk;
  std::string entry = "diffuse";
  double cosine = 1;
  bool json = false, csv = false;
  std::filesystem::path plot;
};

// One annulus of the profile, four to the octave of distance.
struct Annulus {
  double from, to;        // rho
  double radiosity;       // R: energy per unit entered and unit optical area
  double standard_error;  // of it
  double fit;             // the mixture's
};

struct Profile {
  std::vector<Annulus> annuli;
  ExponentialMixture mixture;
  FitError error;
  std::size_t fitted_bins = 0;
};

Profile radial_profile(const AlbedoWalkResult& result) {
  const std::vector<Estimate> energy = result.radial_energy();
  const double total = result.of_entered(result.reflected).value;
  const FitData all = fit_data(energy, total, 1e-3, HUGE_VAL, HUGE_VAL);
  // Bins that the simulation itself knows to 10 %.
  const FitData fitted = fit_data(energy, total, 1e-3, HUGE_VAL, 0.1);
  Profile profile;
  if (fitted.bins.size() >= 10) {
    profile.mixture = fit_by_annealing(fitted, {});
    profile.error = fit_error(profile.mixture, fitted);
    profile.fitted_bins = fitted.bins.size();
  }
  for (const FitData::Bin& bin : all.bins) {
    const double area = pi * (bin.to * bin.to - bin.from * bin.from);
    profile.annuli.push_back({bin.from, bin.to, bin.energy / area, bin.energy * bin.relative_error / area,
                              profile.mixture.energy(bin.from, bin.to) / area});
  }
  return profile;
}

nlohmann::ordered_json to_json(const ProfileArguments& arguments, const AlbedoWalkResult& result,
                               const Profile& profile) {
  nlohmann::ordered_json json;
  json["alpha"] = arguments.walk.albedo;
  json["g"] = arguments.walk.medium.g;
  json["eta"] = arguments.walk.medium.eta;
  json["entry"] = arguments.entry;
  if (arguments.walk.entry == EntryKind::direction) json["cosine"] = arguments.cosine;
  if (arguments.walk.thickness) json["slab"] = *arguments.walk.thickness;
  json["photons"] = result.photons;
  json["seed"] = arguments.walk.seed;
  json["specular"] = result.specular;
  json["reflectance"] = result.reflectance().value;
  json["transmittance"] = result.transmittance().value;
  json["absorbed"] = result.absorbed_fraction().value;
  json["truncated"] = result.truncated_fraction().value;
  json["total_reflectance"] = result.total_reflectance().value;
  json["standard_error"] = result.total_reflectance().standard_error;
  json["A"] = result.specular < 1 ? result.reflectance().value / (1 - result.specular) : 0.0;
  json["standard_errors"] = {{"reflectance", result.reflectance().standard_error},
                             {"transmittance", result.transmittance().standard_error},
                             {"absorbed", result.absorbed_fraction().standard_error}};
  for (const char* key : {"rho_from", "rho_to", "R", "R_standard_error", "R_fit"})
    json["profile"][key] = nlohmann::ordered_json::array();
  for (const Annulus& a : profile.annuli) {
    json["profile"]["rho_from"].push_back(a.from);
    json["profile"]["rho_to"].push_back(a.to);
    json["profile"]["R"].push_back(a.radiosity);
    json["profile"]["R_standard_error"].push_back(a.standard_error);
    json["profile"]["R_fit"].push_back(a.fit);
  }
  json["fit"]["weights"] = nlohmann::ordered_json::array();
  json["fit"]["rates"] = nlohmann::ordered_json::array();
  for (const ExponentialMixture::Component& c : profile.mixture.components) {
    json["fit"]["weights"].push_back(c.weight);
    json["fit"]["rates"].push_back(c.rate);
  }
  json["fit"]["bins"] = profile.fitted_bins;
  json["fit"]["mean_relative_error"] = profile.error.mean;
  json["fit"]["largest_relative_error"] = profile.error.largest;
  json["fit"]["A_relative_error"] = profile.error.total;
  return json;
}

void print_csv(const Profile& profile) {
  fmt::print("rho_from,rho_to,R,standard_error,fit\n");
  for (const Annulus& a : profile.annuli)
    fmt::print("{:.6g},{:.6g},{:.6g},{:.3g},{:.6g}\n", a.from, a.to, a.radiosity, a.standard_error, a.fit);
}

void print_text(const AlbedoWalkResult& result, const Profile& profile) {
  const auto line = [](const char* name, const Estimate& e) {
    fmt::print("{:18} {:.6f} +- {:.6f}\n", name, e.value, e.standard_error);
  };
  line("specular", {result.specular, 0});
  line("reflectance", result.reflectance());
  line("transmittance", result.transmittance());
  line("absorbed", result.absorbed_fraction());
  if (result.truncated > 0) line("truncated", result.truncated_fraction());
  line("total reflectance", result.total_reflectance());
  if (result.specular < 1)
    line("A", {result.reflectance().value / (1 - result.specular),
               result.reflectance().standard_error / (1 - result.specular)});
  if (profile.fitted_bins > 0)
    fmt::print("five exponentials: mean error {:.2f} %, largest {:.2f} %, over {} distances\n",
               100 * profile.error.mean, 100 * profile.error.largest, profile.fitted_bins);
}

void write_plot(const ProfileArguments& arguments, const Profile& profile) {
  Chart chart;
  chart.title = fmt::format("alpha = {}, g = {}, eta = {}", arguments.walk.albedo, arguments.walk.medium.g,
                            arguments.walk.medium.eta);
  chart.x_label = "optical distance rho";
  chart.y_label = "rho R(rho)";
  chart.log_x = chart.log_y = true;
  ChartSeries simulation, fit;
  simulation.name = "simulation";
  simulation.line = false;
  fit.name = "five exponentials";
  fit.points = false;
  for (const Annulus& a : profile.annuli) {
    const double rho = std::sqrt(a.from * a.to);
    simulation.x.push_back(rho);
    simulation.y.push_back(rho * a.radiosity);
    simulation.y_error.push_back(rho * a.standard_error);
    fit.x.push_back(rho);
    fit.y.push_back(rho * a.fit);
  }
  chart.series.push_back(simulation);
  if (profile.fitted_bins > 0) chart.series.push_back(fit);
  write_chart_svg(arguments.plot, chart);
}

void run(const ProfileArguments& arguments) {
  const AlbedoWalkResult result = walk_at_albedo(arguments.walk);
  const Profile profile = radial_profile(result);
  if (!arguments.plot.empty()) write_plot(arguments, profile);
  if (arguments.json)
    std::cout << to_json(arguments, result, profile).dump(2) << '\n';
  else if (arguments.csv)
    print_csv(profile);
  else
    print_text(result, profile);
}

void finish(ProfileArguments& arguments) {
  if (!(arguments.walk.medium.g > -1 && arguments.walk.medium.g < 1))
    throw InputError(fmt::format("--g {}: outside (-1, 1)", arguments.walk.medium.g));
  if (!(arguments.cosine > 0 && arguments.cosine <= 1))
    throw InputError(fmt::format("--cosine {}: outside (0, 1]", arguments.cosine));
  if (arguments.walk.thickness && !(*arguments.walk.thickness > 0))
    throw InputError(fmt::format("--slab {}: not a positive optical thickness", *arguments.walk.thickness));
  arguments.walk.entry = arguments.entry == "normal"    ? EntryKind::normal
                         : arguments.entry == "diffuse" ? EntryKind::diffuse
                                                        : EntryKind::direction;
  arguments.walk.entry_cosine = arguments.cosine;
}

}  // namespace

void add_profile_command(CLI::App& app) {
  auto arguments = std::make_shared<ProfileArguments>();
  AlbedoWalkOptions& walk = arguments->walk;
  CLI::App* command =
      app.add_subcommand("profile", "Simulate one homogeneous half-space or slab: totals and radial profile");
  command->add_option("--alpha", walk.albedo, "single-scattering albedo")
      ->check(between(0, 1))
      ->capture_default_str();
  command->add_option("--g", walk.medium.g, "mean cosine of scattering, in (-1, 1)")->capture_default_str();
  command->add_option("--eta", walk.medium.eta, "relative index of refraction")
      ->check(between(1, 10))
      ->capture_default_str();
  command->add_option("--entry", arguments->entry, "how light arrives: normal, diffuse or direction")
      ->check(CLI::IsMember({"normal", "diffuse", "direction"}))
      ->capture_default_str();
  command->add_option("--cosine", arguments->cosine, "cosine to the normal of --entry direction")
      ->capture_default_str();
  command->add_option("--slab", walk.thickness, "optical thickness of a slab (default: a half-space)");
  command->add_option("--photons", walk.photons, "photons that enter")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 40))
      ->capture_default_str();
  command->add_option("--seed", walk.seed, "random seed")->capture_default_str();
  auto* json = command->add_flag("--json", arguments->json, "all results as JSON on standard output");
  command->add_flag("--csv", arguments->csv, "the radial profile as CSV on standard output")->excludes(json);
  command->add_option("--plot", arguments->plot, "also draw the profile (SVG, needs gnuplot)");
  command->callback([arguments] {
    const PromptExit prompt_exit("alabaster: interrupted; nothing is left of what was simulated\n");
    finish(*arguments);
    run(*arguments);
  });
}

}  // namespace alabaster
