#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// A length as the command line gives it: metres, one per channel, or per cent of the scene's box diagonal.
struct LengthSpecification {
  Rgb value;  // m, or fraction of the diagonal
  bool relative = false;
};
/// Parses "0.01", "0.01,0.005,0.002" or "0.5%"; throws InputError.
LengthSpecification parse_length(const std::string& text);

/// What overrides a model's own materials.
struct LoadOptions {
  std::vector<std::string> subsurface;  // material names that get a medium; empty: the default rule
  std::optional<LengthSpecification> mean_free_path;
  std::optional<double> g, eta;
  std::string subsurface_map;  // image path
  std::string camera;          // name of the camera to use
  bool hide_environment = false;
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
