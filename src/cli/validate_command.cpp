#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "cli/study_options.h"
#include "core/parallel.h"
#include "study/response.h"
#include "study/validation.h"

namespace alabaster {

namespace {

struct ValidateSettings {
  ValidationOptions options;
  StudyOptions study;
  std::vector<std::string> scenes;  // empty: the default of what is measured
  std::string what = "images", quality = "quick";
};

void measure_images(ValidateSettings& settings) {
  ValidationOptions& options = settings.options;
  if (!settings.scenes.empty()) options.scenes = settings.scenes;
  options.mesh_budget = settings.study.applied_to(mesh_budget(options.quality));
  const ValidationResult result = validate(options);
  finish_study(settings.study.output + "/report.html", result.seconds);
}

void measure_response(ValidateSettings& settings) {
  ValidationOptions& options = settings.options;
  options.scenes = settings.scenes.empty() ? response_scenes() : settings.scenes;
  const double start = wall_seconds();
  validate_response(options);
  finish_study(settings.study.output + "/response.html", wall_seconds() - start);
}

void run(ValidateSettings& settings) {
  settings.study.begin();
  settings.options.quality = quality_from_name(settings.quality);
  settings.study.set(settings.options);
  (settings.what == "response" ? measure_response : measure_images)(settings);
}

}  // namespace

void add_validate_command(CLI::App& app) {
  auto settings = std::make_shared<ValidateSettings>();
  CLI::App* command = app.add_subcommand(
      "validate", "Measure every model against the volumetric reference and write a report");
  command
      ->add_option("--what", settings->what,
                   "images: errors of whole images; response: S_V around chosen points of meshes against "
                   "walks from there")
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
  add_study_options(*command, settings->study);
  command->callback([settings] { run(*settings); });
}

}  // namespace alabaster
