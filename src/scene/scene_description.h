#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/media.h"
#include "scene/scene.h"

namespace alabaster {

/// A scene file, read and checked: docs/scene_files.md.
struct SceneDescription {
  std::filesystem::path model;
  std::optional<Camera> camera;
  std::string camera_node;  // camera of the model to use
  std::vector<Light> lights;
  std::unique_ptr<Environment> environment;
  bool environment_visible = true;
  std::map<std::string, MaterialOverride> materials;
  std::map<std::string, std::string> integrator;
};

/// Throws InputError for JSON that does not parse, keys that are not known, and values out of range, naming
/// the file and the place. Paths inside are relative to the file.
SceneDescription read_scene_description(const std::filesystem::path& path);

}  // namespace alabaster
