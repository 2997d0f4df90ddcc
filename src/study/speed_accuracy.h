#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/validation.h"

namespace alabaster {

/// What error a method has after what time.
struct ChartBudget {
  ValidationBudget flat;                         // resolution and reference of flat scenes
  MeshBudget mesh;                               // the same of meshes
  std::vector<uint32_t> spp{1, 4, 16, 64, 256};  // ascending
};
ChartBudget chart_budget(Quality quality);

struct ChartOptions {
  std::vector<std::string> scenes;   // as for validate; empty: the standard eight
  std::vector<std::string> methods;  // empty: all, and the reference's own method `volume`
  Quality quality = Quality::quick;
  std::filesystem::path output;
  std::filesystem::path cache;  // of converged references; empty: the user's
  uint64_t seed = 1;
  std::optional<ChartBudget> budget;  // instead of the quality's
};

/// One method with one number of samples on one scene.
struct ChartRow {
  std::string scene, method;
  uint32_t spp = 0;
  double seconds = 0, cpu_seconds = 0;
  double rmse_over_rms = 0, bias = 0, noise = 0;
  /// rmse_over_rms without the part that is the reference's noise: what the charts draw. The same for all
  /// rows of a scene, that part does not change their order.
  double error = 0;
  bool on_front = false;  // no other row of the scene has less error in less time
};

/// One scene with every method and number of samples measured on it.
struct ChartScene {
  std::string name, title;
  std::string skipped;  // why nothing was measured; empty otherwise
  TimedImage reference;
  std::vector<ChartRow> rows;
  std::vector<std::pair<std::string, Image>> images;  // by method, with the most samples
};

struct ChartResult {
  std::vector<ChartScene> scenes;
  double seconds = 0, cpu_seconds = 0;
  bool cancelled = false;
};

/// Sets on_front of the rows of one scene: the Pareto front of cpu_seconds and rmse_over_rms.
void mark_front(std::vector<ChartRow>& rows);

/// Measures all of it and writes chart.json, SCENE.svg, SCENE.png and chart.html to options.output. Methods
/// take turns, so that a slow moment of the machine hits all of them; few samples are measured several
/// times. Throws InputError for names that are none.
ChartResult chart_speed_and_accuracy(const ChartOptions& options);

}  // namespace alabaster
