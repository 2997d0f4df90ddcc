#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// What a glTF file holds, in world space and metres: one object per node with triangles.
struct GltfScene {
  std::vector<SceneObject> objects;  // mesh and name only
  std::vector<Material> materials;
  std::vector<Light> lights;  // KHR_lights_punctual; candela and lux are taken as W/sr and W/m^2
  std::vector<Camera> cameras;
  std::vector<std::string> warnings;
  std::size_t mesh_count = 0, texture_count = 0, image_count = 0;
};

/// Reads .gltf or .glb: the default scene, or all nodes when the file names none. Throws InputError.
GltfScene import_gltf(const std::filesystem::path& path);

}  // namespace alabaster
