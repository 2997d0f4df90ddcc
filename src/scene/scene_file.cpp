#include "scene/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/progress.h"
#include "scene/framing.h"
#include "scene/gltf_import.h"
#include "scene/json_reader.h"
#include "scene/scene_description.h"

namespace alabaster {

namespace fs = std::filesystem;

namespace {

void take_model(const fs::path& path, Scene& scene) {
  GltfScene model = import_gltf(path);
  if (model.objects.empty()) {
    const std::string why = model.warnings.empty() ? "" : " (" + model.warnings.back() + ")";
    throw InputError(path.string(), "has no triangles to render" + why + "; check what was exported");
  }
  scene.objects = std::move(model.objects);
  scene.materials = std::move(model.materials);
  scene.lights = std::move(model.lights);
  scene.cameras = std::move(model.cameras);
  scene.warnings = std::move(model.warnings);
  scene.mesh_count = model.mesh_count;
  scene.texture_count = model.texture_count;
}

MediumRules rules_from(const LoadOptions& options) {
  MediumRules rules;
  rules.subsurface = options.subsurface;
  rules.mean_free_path = options.mean_free_path;
  rules.g = options.g;
  rules.eta = options.eta;
  rules.subsurface_map = options.subsurface_map;
  return rules;
}

/// Moves the camera of that name to the front.
void choose_camera(Scene& scene, const std::string& name, const std::string& file, const std::string& place) {
  if (name.empty()) return;
  const auto found = std::find_if(scene.cameras.begin(), scene.cameras.end(), [&](const Camera& camera) {
    return camera.name == name || camera.alias == name;
  });
  if (found == scene.cameras.end()) {
    std::vector<std::string> names;
    for (const Camera& camera : scene.cameras) names.push_back(camera.name);
    throw InputError(file, place, "there is no camera '" + name + "'" + suggestion(name, names));
  }
  std::rotate(scene.cameras.begin(), found, found + 1);
}

/// Once the scene is prepared: the camera that a scene without one gets.
void ensure_camera(Scene& scene, bool tell) {
  if (!scene.cameras.empty()) return;
  scene.cameras.push_back(frame_objects(scene));
  if (tell) say(scene.name + ": no camera; framed from the front right");
}

void say_default_length(const Scene& scene, bool given) {
  if (given) return;
  for (const Material& material : scene.materials) {
    if (!material.medium || material.medium_reason.find("default rule") == std::string::npos) continue;
    say(fmt::format("{}: mean free path {:.3g} m, 0.5 % of the box diagonal; change it with --mean-free-path",
                    scene.name, material.medium->mean_free_path.r));
    return;
  }
}

void load_bare_model(const fs::path& path, const LoadOptions& options, LoadedScene& loaded) {
  Scene& scene = loaded.scene;
  take_model(path, scene);
  apply_medium_rules(scene, rules_from(options), path.string());
  say_default_length(scene, options.mean_free_path.has_value());
  prepare_scene(scene, options.purpose);
  ensure_camera(scene, true);
  // The key comes from the upper left of the camera.
  const Camera& camera = scene.cameras.front();
  const Vec3 back = glm::normalize(Vec3(-camera.direction.x, 0, -camera.direction.z) + Vec3(0, 0, 1e-9));
  const Vec3 right = glm::cross(Vec3(0, 1, 0), back);
  SkyParameters sky;
  sky.direction = glm::normalize(-0.6 * right + Vec3(0, 0.62, 0) + 0.5 * back);
  scene.environment = make_sky_environment(sky);
  say(fmt::format("{}: lit by the sky 0.15 + 3 max(0, w . l)^4, l = ({:.2f}, {:.2f}, {:.2f}){}", scene.name,
                  sky.direction.x, sky.direction.y, sky.direction.z,
                  scene.lights.empty() ? "" : ", and by its own lights"));
}

void load_description(const fs::path& path, const LoadOptions& options, LoadedScene& loaded) {
  Scene& scene = loaded.scene;
  SceneDescription description = read_scene_description(path);
  take_model(description.model, scene);
  MediumRules rules = rules_from(options);
  rules.overrides = std::move(description.materials);
  apply_medium_rules(scene, rules, path.string());
  scene.lights.insert(scene.lights.end(), description.lights.begin(), description.lights.end());
  prepare_scene(scene, options.purpose);
  scene.environment = std::move(description.environment);
  scene.environment_visible = description.environment_visible;
  if (description.camera) scene.cameras.insert(scene.cameras.begin(), *description.camera);
  choose_camera(scene, description.camera_node, path.string(), "camera.node");
  ensure_camera(scene, true);
  loaded.integrator = std::move(description.integrator);
  if (scene.lights.empty() && !scene.environment)
    scene.warnings.push_back("the scene has no light: give it an environment or lights");
}

}  // namespace

LoadedScene load_scene(const fs::path& path, const LoadOptions& options) {
  LoadedScene loaded;
  loaded.scene.name = path.string();
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".json") {
    load_description(path, options, loaded);
  } else if (extension == ".glb" || extension == ".gltf") {
    load_bare_model(path, options, loaded);
  } else {
    throw InputError(path.string(),
                     "is neither a scene (.json) nor a model (.glb, .gltf); export it as glTF 2.0");
  }
  choose_camera(loaded.scene, options.camera, path.string(), "--camera");
  if (options.hide_environment) loaded.scene.environment_visible = false;
  return loaded;
}

}  // namespace alabaster
