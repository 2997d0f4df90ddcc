#pragma once

#include <string>
#include <vector>

#include "integrators/surface.h"
#include "scene/scene.h"

namespace alabaster {

/// A scene of meshes that a study renders: one of the procedural ones, or anything that `render` takes.
struct MeshScene {
  std::string name;   // the id, or the file's name without its extension
  std::string title;  // for people
  Scene scene;
  int width = 0, height = 0;

  /// What all methods share: the first camera, the environment hidden, the specular part left out (mirror
  /// images and light that never scattered are the same for every method).
  SurfaceOptions options() const;
};

/// Whether a name given to --scenes means meshes rather than flat scenes: an id of the set "mesh", the set, a
/// model (.glb, .gltf) or a scene file with a "model". Throws InputError for a scene file that cannot be
/// read.
bool is_mesh_scene_name(const std::string& name);

/// Ids, the set "mesh" and files as a list of ids and files. The set brings along the models in
/// $ALABASTER_EXTRA/assets when there are any.
std::vector<std::string> expand_mesh_scenes(const std::vector<std::string>& names);

/// Loads it for images whose longer side is `resolution` pixels. Throws InputError.
MeshScene load_mesh_scene(const std::string& name, int resolution);

/// Replaces the albedo of every object by its mean over the object's surface: what is left of a method's
/// error then is that of the shape. Integrators made before must not be used any more.
void flatten_albedo(Scene& scene);

/// Why the volumetric reference cannot render a scene; empty when it can.
std::string obstacle_to_reference(const MeshScene& scene);

}  // namespace alabaster
