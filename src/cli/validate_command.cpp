#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "core/cancellation.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "study/response.h"
#include "study/validation.h"

namespace alabaster {

namespace {

struct ValidateSettings {
  ValidationOptions options;
  std::vector<std::string> scenes;  // empty: the default of what is measured
  std::string what = "images", quality = "quick", output, cache;
  int threads = 0;
};

void measure_images(ValidateSettings& settings) {
  if (!settings.scenes.empty()) settings.options.scenes = settings.scenes;
  const ValidationResult result = validate(settings.options);
  say(settings.output + "/report.html written after " + format_duration(result.seconds));
}

void measure_response(ValidateSettings& settings) {
  settings.options.scenes = settings.scenes.empty() ? response_scenes() : settings.scenes;
  validate_response(settings.options);
  say(settings.output + "/response.html written");
}

void run(ValidateSettings& settings) {
  set_thread_count(settings.threads);
  settings.options.quality = quality_from_name(settings.quality);
  settings.options.output = settings.output;
  settings.options.cache = settings.cache;
  (settings.what == "response" ? measure_response : measure_images)(settings);
  if (cancellation_requested()) {
    say("stopped; what was finished is written");
    set_exit_code(interrupted_exit_code);
  }
}

}  // namespace

void add_validate_command(CLI::App& app) {
  auto settings = std::make_shared<ValidateSettings>();
  CLI::App* command = app.add_subcommand(
      "validate", "Measure every model against the volumetric reference and write a report");
  command
      ->add_option(
          "--what", settings->what,
          "images: errors of whole images; response: S_V around chosen points of meshes against walks "
          "from there")
      ->check(CLI::IsMember({"images", "response"}))
      ->capture_default_str();
  command
      ->add_option("--scenes", settings->scenes,
                   "Scenes or sets, separated by commas: planar (the default), mesh, stripes1, stripes1@45, "
                   "stripes1@radiosity, blob, FLAT.json, MODEL.glb, SCENE.json ...")
      ->delimiter(',');
  command
      ->add_option("--models", settings->options.models,
                   "Models, separated by commas; flat: composite, composite:symmetric, aggregate:0.5, "
                   "composite:uniform ...; meshes: composite+half-space, walk ...")
      ->delimiter(',');
  command->add_option("--quality", settings->quality, "quick (minutes) or full (an hour)")
      ->capture_default_str();
  command->add_option("-o,--output", settings->output, "Folder for the report")->required();
  command->add_option("--cache", settings->cache, "Folder of converged references (the user's cache)");
  command->add_option("--seed", settings->options.seed, "Seed of all random numbers")->capture_default_str();
  command->add_option("--threads", settings->threads, "Number of threads; 0: all cores")
      ->capture_default_str();
  command->callback([settings] { run(*settings); });
}

}  // namespace alabaster
