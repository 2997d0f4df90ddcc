#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "study/mesh_validation.h"

namespace CLI {
class App;
}

namespace alabaster {

/// What validate and chart are told alike.
struct StudyOptions {
  std::string output, cache;
  uint64_t seed = 1;
  int threads = 0;
  std::optional<int> resolution;  // of meshes
  std::optional<double> noise;    // of the references of meshes

  /// Sets the threads, and refuses a folder that cannot be written before an hour of work. InputError.
  void begin() const;

  /// Where the files of a study go and its seed, which all kinds of options hold under these names.
  template <typename Options>
  void set(Options& options) const {
    options.output = output;
    options.cache = cache;
    options.seed = seed;
  }

  /// The budget with what was asked for in its place.
  MeshBudget applied_to(MeshBudget budget) const;
};

void add_study_options(CLI::App& command, StudyOptions& options);

/// Says where the result lies, and sets the exit code when a stop was asked for.
void finish_study(const std::string& page, double seconds);

}  // namespace alabaster
