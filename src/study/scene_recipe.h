#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// One object of a recipe with one material.
struct RecipePart {
  std::string name;  // of the object and of its material
  TriangleMesh mesh;
  std::optional<Medium> medium;               // none: opaque
  std::shared_ptr<const TexelArray> texture;  // of the meaning below; empty: colour alone
  Rgb colour{1};                              // times the texture
  AlbedoSource::Meaning meaning = AlbedoSource::Meaning::reflectance;
  Wrap wrap = Wrap::repeat;
  double roughness = 0.5;
  Rgb emission{0};  // W/(sr m^2)
};

/// A procedural scene before it becomes either a Scene in memory or files: one description for both.
struct SceneRecipe {
  std::string id, title;
  std::vector<RecipePart> parts;
  Camera camera;
  std::vector<Light> lights;  // directional, point, spot, disk, patch
  SkyParameters sky;
  bool sky_visible = false;
  /// Options of render that suit the scene: name with underscores, text.
  std::vector<std::pair<std::string, std::string>> options;
};

/// The mesh scenes of the studies. All are about 0.1 m across with the mean free path their ids ask for; the
/// albedo is two-tone (0.95 / 0.5) in slabs across (2, 3, 1), one period per mean free path but at most
/// twenty across the object; the light is the analytic sky, hidden from the camera, for the slabs from
/// behind. Throws InputError when no mesh scene has that id.
SceneRecipe make_mesh_study_recipe(const std::string& id);

/// The study's blob with about that many triangles (12 n^2, n >= 1), for figures over the size of a mesh:
/// same shape, view and texture at every size; `textured` false: one albedo, 0.9.
SceneRecipe make_blob_recipe(std::size_t triangles, bool textured);

/// The recipe in memory, prepared for rendering.
Scene build_scene(SceneRecipe recipe);

/// Writes ID.glb and ID.json into `folder`, for `alabaster render`. Albedos become the base colours that give
/// them back on loading (the baseline's reflectance, 8 bits per channel).
void write_scene_files(const SceneRecipe& recipe, const std::filesystem::path& folder);

/// Writes NAME.png into `folder`: a pattern of texture/patterns.h as data (no sRGB), albedo 1 being white. It
/// is what a scene file's "albedo" takes. Throws InputError.
void write_pattern_file(const std::string& name, const std::filesystem::path& folder);

}  // namespace alabaster
