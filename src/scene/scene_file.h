#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/media.h"
#include "scene/scene.h"

namespace alabaster {

/// What overrides a model's own materials.
struct LoadOptions {
  std::vector<std::string> subsurface;  // material names that get a medium; empty: the default rule
  std::optional<LengthSpecification> mean_free_path;
  std::optional<double> g, eta;
  std::string subsurface_map;  // image path
  std::string camera;          // name of the camera to use
  bool hide_environment = false;
  Purpose purpose = Purpose::render;
};

struct LoadedScene {
  Scene scene;
  /// The "integrator" object of a scene file, flattened to option name -> text; empty for a bare model.
  std::map<std::string, std::string> integrator;
};

/// Loads SCENE.json, MODEL.glb or MODEL.gltf, prepared for rendering. A bare model gets a framed camera, the
/// analytic sky and a mean free path of 0.5 % of its box diagonal, and says so. Throws InputError with file,
/// place and mend.
LoadedScene load_scene(const std::filesystem::path& path, const LoadOptions& options);

}  // namespace alabaster
