#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/option_checks.h"
#include "core/cancellation.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "optics/bake.h"
#include "optics/profile_store.h"
#include "optics/shape_bake.h"
#include "study/optics_report.h"
#include "study/shape_report.h"

namespace alabaster {

namespace {

struct BakeArguments {
  double g = 0.3, eta = 1.5;
  std::string quality = "quick";
  uint64_t photons = 0;  // 0: as the quality says
  uint64_t seed = 1;
  std::string view = "all";
  bool shapes = false;
  std::filesystem::path output;
  std::filesystem::path report;
};

void report(const BakeArguments& arguments, uint64_t photons, uint64_t collisions, double start,
            double cpu_start) {
  say(fmt::format("{}: {} photons, {:.3g} collisions, {} ({:.1f} M collisions per CPU second)",
                  arguments.output.string(), photons, static_cast<double>(collisions),
                  format_duration(wall_seconds() - start),
                  1e-6 * static_cast<double>(collisions) / (cpu_seconds() - cpu_start)));
}

void run_shapes(const BakeArguments& arguments) {
  if (arguments.view != "all") throw InputError("--shapes tabulates all outgoing light; leave out --view");
  ShapeBakeOptions options;
  options.medium = {arguments.g, arguments.eta};
  options.seed = arguments.seed;
  options.photons = arguments.photons > 0          ? arguments.photons
                    : arguments.quality == "quick" ? quick_shape_photons
                                                   : full_shape_photons;
  ProfileRequest request;
  request.g = arguments.g;
  request.eta = arguments.eta;
  const auto half_space = profile_for(request);
  const double start = wall_seconds(), cpu_start = cpu_seconds();
  ShapeTable table;
  {
    Progress progress("baking shapes");
    table = bake_shapes(options, *half_space, [&](double done) { progress.update(done); });
  }
  write_shape_table(arguments.output, table);
  if (!arguments.report.empty()) write_shape_report(table, *half_space, arguments.report);
  report(arguments, table.photons, table.collisions, start, cpu_start);
}

void run(const BakeArguments& arguments) {
  if (arguments.shapes) return run_shapes(arguments);
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
  report(arguments, table.photons, table.collisions, start, cpu_start);
}

}  // namespace

void add_bake_command(CLI::App& app) {
  auto arguments = std::make_shared<BakeArguments>();
  CLI::App* command = app.add_subcommand("bake", "Simulate the half-space and write its profile table");
  command->add_option("--g", arguments->g, "mean cosine of scattering")
      ->check(between(-0.99, 0.99))
      ->capture_default_str();
  command->add_option("--eta", arguments->eta, "relative index of refraction")
      ->check(between(1, 4))
      ->capture_default_str();
  command->add_option("--quality", arguments->quality, "quick or full")
      ->check(CLI::IsMember({"quick", "full"}))
      ->capture_default_str();
  command->add_option("--view", arguments->view, "outgoing light tabulated: all of it, or along the normal")
      ->check(CLI::IsMember({"all", "normal"}))
      ->capture_default_str();
  command->add_flag("--shapes", arguments->shapes,
                    "simulate balls, cavities and slabs instead, for the shape basis");
  command
      ->add_option("--photons", arguments->photons,
                   "number of photons (--shapes: per body) instead of the quality's")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 40));
  command->add_option("--seed", arguments->seed, "random seed")->capture_default_str();
  command->add_option("-o,--output", arguments->output, "table file to write")->required();
  command->add_option(
      "--report", arguments->report,
      "folder for figures: the table's and other fits' accuracy against a second simulation; with "
      "--shapes the factors");
  command->callback([arguments] {
    const PromptExit prompt_exit("alabaster: interrupted; no table was written\n");
    run(*arguments);
  });
}

}  // namespace alabaster
