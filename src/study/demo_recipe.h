#pragma once

#include <string>
#include <vector>

#include "study/scene_recipe.h"

namespace alabaster {

/// The picture on the first page: a lotus bowl of veined stone lit from behind, a jade pebble beside it,
/// before a grey backdrop.
SceneRecipe make_demo_recipe();

/// Shapes of geometry/shapes.h that no study uses, in veined stone, for trying the renderer on: plane,
/// cavity, and whatever else recipe_names() lists beside the study's meshes. Throws InputError for other
/// names.
SceneRecipe make_recipe(const std::string& name);
/// What make_recipe() knows: "demo", "plane", "cavity", and the ids of the set "mesh".
const std::vector<std::string>& recipe_names();

}  // namespace alabaster
