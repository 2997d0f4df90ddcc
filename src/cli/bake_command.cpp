#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "optics/bake.h"
#include "study/optics_report.h"

namespace alabaster {

namespace {

struct BakeArguments {
  double g = 0.3, eta = 1.5;
  std::string quality = "quick";
  uint64_t photons = 0;  // 0: as the quality says
  uint64_t seed = 1;
  std::string view = "all";
  std::filesystem::path output;
  std::filesystem::path report;
};

void run(const BakeArguments& arguments) {
  if (!arguments.report.empty() && arguments.view != "all")
    throw InputError("--report measures tables of all outgoing light; leave out --view normal");
  BakeOptions options;
  options.medium = {arguments.g, arguments.eta};
  options.seed = arguments.seed;
  options.view = arguments.view == "normal" ? TableView::normal : TableView::all;
  options.photons = arguments.photons > 0          ? arguments.photons
                    : arguments.quality == "quick" ? quick_photons
                                                   : full_photons;
  const double start = wall_seconds(), cpu_start = cpu_seconds();
  TableData table;
  {
    Progress progress("baking");
    table = bake_table(options, [&](double done) { progress.update(done); });
  }
  write_table(arguments.output, table);
  if (!arguments.report.empty()) {
    Progress progress("simulating once more to measure the table");
    const HalfSpaceWalkOptions check{options.medium, options.photons / 2, options.seed + 100, false};
    write_optics_report(half_space_tally(check, [&](double done) { progress.update(done); }), table,
                        arguments.report);
  }
  say(fmt::format("{}: {} photons, {:.3g} collisions, {} ({:.1f} M collisions per CPU second)",
                  arguments.output.string(), table.photons, static_cast<double>(table.collisions),
                  format_duration(wall_seconds() - start),
                  1e-6 * static_cast<double>(table.collisions) / (cpu_seconds() - cpu_start)));
}

}  // namespace

void add_bake_command(CLI::App& app) {
  auto arguments = std::make_shared<BakeArguments>();
  CLI::App* command = app.add_subcommand("bake", "Simulate the half-space and write its profile table");
  command->add_option("--g", arguments->g, "mean cosine of scattering")
      ->check(CLI::Range(-0.99, 0.99))
      ->capture_default_str();
  command->add_option("--eta", arguments->eta, "relative index of refraction")
      ->check(CLI::Range(1.0, 4.0))
      ->capture_default_str();
  command->add_option("--quality", arguments->quality, "quick or full")
      ->check(CLI::IsMember({"quick", "full"}))
      ->capture_default_str();
  command->add_option("--view", arguments->view, "outgoing light tabulated: all of it, or along the normal")
      ->check(CLI::IsMember({"all", "normal"}))
      ->capture_default_str();
  command->add_option("--photons", arguments->photons, "number of photons instead of the quality's");
  command->add_option("--seed", arguments->seed, "random seed")->capture_default_str();
  command->add_option("-o,--output", arguments->output, "table file to write")->required();
  command->add_option(
      "--report", arguments->report,
      "folder for figures of the table's and other fits' accuracy, against a second simulation");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace alabaster
