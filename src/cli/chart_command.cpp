#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "core/cancellation.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "study/speed_accuracy.h"

namespace alabaster {

namespace {

struct ChartSettings {
  ChartOptions options;
  std::string what = "speed", budgets = "quick", output, cache;
  int threads = 0;
};

void run(ChartSettings& settings) {
  set_thread_count(settings.threads);
  settings.options.quality = quality_from_name(settings.budgets);
  settings.options.output = settings.output;
  settings.options.cache = settings.cache;
  const ChartResult result = chart_speed_and_accuracy(settings.options);
  if (result.cancelled) {
    say("stopped; what was finished is written");
    set_exit_code(interrupted_exit_code);
  }
  say(settings.output + "/chart.html written after " + format_duration(result.seconds));
}

}  // namespace

void add_chart_command(CLI::App& app) {
  auto settings = std::make_shared<ChartSettings>();
  CLI::App* command =
      app.add_subcommand("chart", "Chart every method's error against the reference over its time");
  command->add_option("--what", settings->what, "speed: error over CPU time")
      ->check(CLI::IsMember({"speed"}))
      ->capture_default_str();
  command
      ->add_option(
          "--scenes", settings->options.scenes,
          "Scenes or sets, separated by commas: planar, mesh, stripes1, blob, MODEL.glb, SCENE.json ... "
          "(stripes1,floral,sphere_3,sphere_10,torus,blob,fold,slab_2)")
      ->delimiter(',');
  command
      ->add_option("--methods", settings->options.methods,
                   "Methods, separated by commas: composite+half-space, walk, volume ... (all)")
      ->delimiter(',');
  command->add_option("--budgets", settings->budgets, "quick (20 minutes) or full (hours)")
      ->capture_default_str();
  command->add_option("-o,--output", settings->output, "Folder for charts and chart.json")->required();
  command->add_option("--cache", settings->cache, "Folder of converged references (the user's cache)");
  command->add_option("--seed", settings->options.seed, "Seed of all random numbers")->capture_default_str();
  command->add_option("--threads", settings->threads, "Number of threads; 0: all cores")
      ->capture_default_str();
  command->callback([settings] { run(*settings); });
}

}  // namespace alabaster
