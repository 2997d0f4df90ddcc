#include "study/mesh_scene.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/rng.h"
#include "scene/scene_file.h"
#include "study/scene_recipe.h"
#include "study/scene_sets.h"
#include "texture/material_map.h"

namespace alabaster {

namespace fs = std::filesystem;

namespace {

std::string extension_of(const std::string& name) {
  std::string extension = fs::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_model(const std::string& name) {
  return extension_of(name) == ".glb" || extension_of(name) == ".gltf";
}

bool is_study_mesh(const std::string& name) {
  return std::any_of(study_scenes().begin(), study_scenes().end(),
                     [&](const StudyScene& scene) { return scene.id == name && scene.set == "mesh"; });
}

/// Models that are there beside the repository: scene files, and models that no scene file is named after.
std::vector<std::string> extra_scenes() {
  const char* extra = std::getenv("ALABASTER_EXTRA");
  if (extra == nullptr || *extra == '\0') return {};
  std::vector<std::string> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fs::path(extra) / "assets", ignored)) {
    const fs::path& path = entry.path();
    const bool described = fs::exists(fs::path(path).replace_extension(".json"));
    if (path.extension() == ".json" || (is_model(path.string()) && !described))
      files.push_back(path.string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Width over height that a scene file's "size" asks for.
double aspect_of(const std::map<std::string, std::string>& integrator) {
  const auto size = integrator.find("size");
  if (size == integrator.end()) return 1;
  double sides[2] = {1, 1};
  const std::string& text = size->second;
  const std::size_t x = text.find('x');
  if (x == std::string::npos) return 1;
  std::from_chars(text.data(), text.data() + x, sides[0]);
  std::from_chars(text.data() + x + 1, text.data() + text.size(), sides[1]);
  return sides[0] > 0 && sides[1] > 0 ? sides[0] / sides[1] : 1;
}

/// Mean over the triangles with a medium, a few random points on each.
Rgb mean_over_surface(const Scene& scene, const SceneObject& object) {
  constexpr int points = 4;
  Rng rng(1);
  Rgb sum;
  double area = 0;
  for (uint32_t t = 0; t < object.mesh.triangle_count(); ++t) {
    if (!scene.materials[object.mesh.materials[t]].medium) continue;
    const double share = object.mesh.area(t) / points;
    for (int i = 0; i < points; ++i) {
      const double r = std::sqrt(rng.uniform()), v = rng.uniform();
      sum += object.albedo->at(object.mesh.surface_point(t, {r * (1 - v), r * v})) * share;
      area += share;
    }
  }
  return area > 0 ? sum / area : Rgb();
}

}  // namespace

SurfaceOptions MeshScene::options() const {
  SurfaceOptions options;
  options.width = width;
  options.height = height;
  options.camera = scene.cameras.front();
  options.environment_visible = false;
  options.specular = false;
  return options;
}

bool is_mesh_scene_name(const std::string& name) {
  if (name == "mesh" || is_study_mesh(name) || is_model(name)) return true;
  if (extension_of(name) != ".json") return false;
  const auto json = nlohmann::json::parse(read_text(name), nullptr, false);
  return json.is_object() && json.contains("model");
}

std::vector<std::string> expand_mesh_scenes(const std::vector<std::string>& names) {
  std::vector<std::string> ids, files;
  for (const std::string& name : names) {
    if (name == "mesh" || is_study_mesh(name)) ids.push_back(name);
    if (name == "mesh") {
      const std::vector<std::string> extra = extra_scenes();
      files.insert(files.end(), extra.begin(), extra.end());
    } else if (!is_study_mesh(name)) {
      files.push_back(name);
    }
  }
  std::vector<std::string> all = expand_scene_ids(ids);
  for (const std::string& file : files)
    if (std::find(all.begin(), all.end(), file) == all.end()) all.push_back(file);
  return all;
}

MeshScene load_mesh_scene(const std::string& name, int resolution) {
  MeshScene result;
  double aspect = 1;
  if (is_study_mesh(name)) {
    SceneRecipe recipe = make_mesh_study_recipe(name);
    result.name = name;
    result.title = recipe.title;
    result.scene = build_scene(std::move(recipe));
  } else {
    LoadedScene loaded = load_scene(name, {});
    result.name = result.title = fs::path(name).stem().string();
    result.scene = std::move(loaded.scene);
    aspect = aspect_of(loaded.integrator);
  }
  const auto side = [&](double share) {
    return std::max(1, static_cast<int>(std::lround(resolution * std::min(1.0, share))));
  };
  result.width = side(aspect);
  result.height = side(1 / aspect);
  return result;
}

void flatten_albedo(Scene& scene) {
  for (SceneObject& object : scene.objects)
    if (object.albedo) object.albedo = std::make_unique<ConstantAlbedo>(mean_over_surface(scene, object));
}

std::string obstacle_to_reference(const MeshScene& scene) {
  SurfaceOptions options = scene.options();
  options.transport = Transport::volume;
  try {
    const SurfaceIntegrator integrator(scene.scene, options);
  } catch (const InputError& error) {
    return error.what();
  }
  const auto has_medium = [](const Material& material) { return material.medium.has_value(); };
  if (std::none_of(scene.scene.materials.begin(), scene.scene.materials.end(), has_medium))
    return scene.name + ": nothing in it has a medium";
  return "";
}

}  // namespace alabaster
