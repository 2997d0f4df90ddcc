#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/footprint.h"
#include "study/mesh_validation.h"
#include "study/planar_figures.h"
#include "study/planar_method.h"

namespace alabaster {

enum class Quality { quick, full };
/// Parses "quick" or "full"; throws InputError.
Quality quality_from_name(const std::string& name);

/// What the flat scenes are measured with.
struct ValidationBudget {
  int resolution = 100;            // pixels per side
  double reference_noise = 0.003;  // of the reference, RMSE / RMS
  double reference_known = 0.96;   // of the reference's pixels, known to a tenth: for the log ratio
  double floor_noise = 0.005;      // of the reference on the constant texture
  uint64_t max_paths = 400'000'000;
  uint32_t spp = 128;       // of the models
  uint32_t sweep_spp = 64;  // of the aggregate model's widths
  uint64_t footprint_paths = 300'000;
  uint64_t map_paths = 4'000'000;  // of a kernel map
};
ValidationBudget budget(Quality quality);
MeshBudget mesh_budget(Quality quality);

/// What the response of points is measured with (study/response.h).
struct ResponseBudget {
  uint64_t walks = 1'000'000;  // of an exit's tally
  int resolution = 128;        // pixels of the maps
};

/// One flat scene with everything measured on it.
struct SceneResult {
  PlanarScene scene;
  TimedImage reference;
  std::vector<MethodResult> methods;
  std::vector<MethodResult> sweep;  // aggregate, by the width of its ellipse
  /// The homogeneous model on a constant texture of the scene's mean albedo, against its own reference: what
  /// no treatment of texture can get below.
  Rgb constant_albedo;
  MethodResult floor;
};

/// S_V(x, exit) over the view, for one exit point: the models, and the reference by reciprocity (light on one
/// pixel, radiosity of all others).
struct KernelMap {
  std::string scene;
  Vec2 exit{0};                                     // m
  std::vector<std::pair<std::string, Image>> maps;  // R G B in 1/m^2; the reference first
};

/// References come from `store` when one is given.
SceneResult measure_scene(const PlanarScene& scene, const std::vector<PlanarMethod>& methods,
                          const ProfileTable& profile, const ValidationBudget& budget, bool sweep,
                          uint64_t seed, ReferenceStore* store = nullptr);
KernelMap measure_kernel(const PlanarScene& scene, Vec2 exit, const std::vector<PlanarMethod>& methods,
                         const ProfileTable& profile, const ValidationBudget& budget, uint64_t seed);

struct ValidationOptions {
  /// Ids (of flat scenes also ID@45, ID@75, ID@radiosity), sets, flat scene files, models, scene files.
  std::vector<std::string> scenes{"planar"};
  std::vector<std::string> models;  // empty: every model and variant
  Quality quality = Quality::quick;
  std::filesystem::path output;
  std::filesystem::path cache;  // of converged references; empty: the user's
  uint64_t seed = 1;
  std::optional<MeshBudget> mesh_budget;  // instead of the quality's
  std::optional<ResponseBudget> response_budget;
};

struct ValidationResult {
  std::vector<SceneResult> scenes;
  std::vector<MeshSceneResult> meshes;
  std::vector<KernelMap> maps;
  std::vector<FootprintOptions> footprint_options;
  std::vector<std::vector<Footprint>> footprints;            // one set per options
  std::optional<PlanarSpeed> speed;                          // on the first flat scene
  std::vector<std::pair<std::string, EnergyExcess>> excess;  // of the composite model, by flat scene
  double seconds = 0, cpu_seconds = 0;
  bool cancelled = false;
};

/// Measures all of it and writes results.json, results.csv, the images as EXR and report.html to
/// options.output. Throws InputError for names that are none.
ValidationResult validate(const ValidationOptions& options);

}  // namespace alabaster
