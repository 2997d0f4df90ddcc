#include "cli/study_options.h"

#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "cli/option_checks.h"
#include "core/atomic_file.h"
#include "core/cancellation.h"
#include "core/parallel.h"
#include "core/progress.h"

namespace alabaster {

void StudyOptions::begin() const {
  set_thread_count(threads);
  require_folder(output, output);
}

MeshBudget StudyOptions::applied_to(MeshBudget budget) const {
  if (resolution) budget.resolution = *resolution;
  if (noise) budget.reference_noise = *noise;
  return budget;
}

void add_study_options(CLI::App& command, StudyOptions& options) {
  command.add_option("-o,--output", options.output, "Folder for the report")->required();
  command
      .add_option("--resolution", options.resolution,
                  "Meshes: pixels of the longer side (quick 96, full 256)")
      ->check(CLI::Range(1, 8192));
  command
      .add_option("--reference-noise", options.noise,
                  "Meshes: noise of the references, RMSE / RMS (quick 0.05, full 0.02)")
      ->check(between(1e-4, 1));
  command.add_option("--cache", options.cache, "Folder of converged references (the user's cache)");
  command.add_option("--seed", options.seed, "Seed of all random numbers")->capture_default_str();
  command.add_option("--threads", options.threads, "Number of threads; 0: all cores")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
}

void finish_study(const std::string& page, double seconds) {
  if (cancellation_requested()) {
    say("stopped; what was finished is written");
    set_exit_code(interrupted_exit_code);
  }
  say(page + " written after " + format_duration(seconds));
}

}  // namespace alabaster
