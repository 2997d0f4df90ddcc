#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "cli/study_options.h"
#include "core/cancellation.h"
#include "core/error.h"
#include "core/parallel.h"
#include "study/geodesic_chart.h"
#include "study/pyramid_chart.h"
#include "study/speed_accuracy.h"

namespace alabaster {

namespace {

struct ChartSettings {
  ChartOptions options;
  StudyOptions study;
  std::string what = "speed", budgets = "quick";
};

/// Studies without pictures: `chart` writes what it measured into the folder.
template <class Options>
void run_study(const ChartSettings& settings, void (*chart)(const Options&)) {
  const PromptExit prompt_exit("alabaster: interrupted; no chart was written\n");
  const double start = wall_seconds();
  Options options;
  options.output = settings.study.output;
  options.seed = settings.study.seed;
  chart(options);
  finish_study(settings.study.output + "/chart.html", wall_seconds() - start);
}

// An option that changes nothing would look as if it did.
void refuse_options_of_speed(const CLI::App& command, const std::string& what) {
  for (const char* option :
       {"--scenes", "--methods", "--budgets", "--resolution", "--reference-noise", "--cache"})
    if (command.count(option) > 0)
      throw InputError(option, fmt::format("means nothing for --what {}; leave it out", what));
}

void run(ChartSettings& settings) {
  settings.study.begin();
  if (settings.what == "geodesic") return run_study(settings, &chart_geodesics);
  if (settings.what == "pyramids") return run_study(settings, &chart_pyramids);
  ChartOptions& options = settings.options;
  options.quality = quality_from_name(settings.budgets);
  settings.study.set(options);
  options.budget = chart_budget(options.quality);
  options.budget->mesh = settings.study.applied_to(options.budget->mesh);
  const ChartResult result = chart_speed_and_accuracy(options);
  finish_study(settings.study.output + "/chart.html", result.seconds);
}

}  // namespace

void add_chart_command(CLI::App& app) {
  auto settings = std::make_shared<ChartSettings>();
  CLI::App* command =
      app.add_subcommand("chart", "Chart every method's error against the reference over its time");
  command
      ->add_option("--what", settings->what,
                   "speed: every method's error over CPU time; geodesic: distances over surfaces; "
                   "pyramids: averages of albedo on seamed surfaces")
      ->check(CLI::IsMember({"speed", "geodesic", "pyramids"}))
      ->capture_default_str();
  command
      ->add_option("--scenes", settings->options.scenes,
                   "Scenes or sets, separated by commas: planar, mesh, stripes1, blob, MODEL.glb, SCENE.json "
                   "... (stripes1,floral,sphere_3,sphere_10,torus,blob,fold,slab_2)")
      ->delimiter(',');
  command
      ->add_option("--methods", settings->options.methods,
                   "Methods, separated by commas: composite+half-space, walk, volume ... (all)")
      ->delimiter(',');
  command->add_option("--budgets", settings->budgets, "quick (20 minutes) or full (hours)")
      ->capture_default_str();
  add_study_options(*command, settings->study);
  command->callback([settings, command] {
    if (settings->what != "speed") refuse_options_of_speed(*command, settings->what);
    run(*settings);
  });
}

}  // namespace alabaster
