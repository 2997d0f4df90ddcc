#include "study/demo_recipe.h"

#include <algorithm>

#include "core/error.h"
#include "geometry/shapes.h"
#include "geometry/still_life.h"
#include "study/scene_sets.h"
#include "texture/patterns.h"
#include "texture/solid_texture.h"

namespace alabaster {

namespace {

RecipePart bowl() {
  RecipePart part;
  part.name = "alabaster";
  part.mesh = make_lotus_bowl();
  StoneParameters stone;
  stone.body = {0.93, 0.89, 0.81};
  stone.cloud = {0.86, 0.76, 0.62};
  stone.vein = {0.16, 0.06, 0.025};
  stone.scale = 0.04;
  stone.vein_width = 0.1;
  stone.vein_strength = 1;
  stone.seed = 2;
  part.texture =
      std::make_shared<TexelArray>(bake_solid(part.mesh, 896, 560, solid_stone(stone), stone.body));
  part.medium = Medium{{0.0010, 0.0008, 0.00065}, 0.3, 1.5};
  part.roughness = 0.35;
  return part;
}

RecipePart pebble() {
  RecipePart part;
  part.name = "jade";
  const Mat3 flattened(1, 0, 0, 0, 0.62, 0, 0, 0, 0.8);
  part.mesh = transformed(make_blob(0.032, 0.10, 96), flattened, {0.118, 0.0, 0.078});
  const double floor = bounding_box(part.mesh).low.y;
  for (Vec3& p : part.mesh.positions) p.y -= floor;
  StoneParameters stone;
  stone.body = {0.25, 0.58, 0.32};
  stone.cloud = {0.50, 0.76, 0.52};
  stone.vein = {0.90, 0.93, 0.80};
  stone.scale = 0.03;
  stone.vein_width = 0.06;
  stone.vein_strength = 0.7;
  stone.seed = 9;
  part.texture =
      std::make_shared<TexelArray>(bake_solid(part.mesh, 400, 400, solid_stone(stone), stone.body));
  part.medium = Medium{{0.0009, 0.0014, 0.0010}, 0.3, 1.5};
  part.roughness = 0.25;
  return part;
}

RecipePart backdrop() {
  RecipePart part;
  part.name = "backdrop";
  part.mesh = transformed(make_backdrop(5.0, 3.2, 2.0, 0.7), Mat3(1), {0, 0, 0});
  part.colour = Rgb(0.05, 0.055, 0.07);
  part.roughness = 0.9;
  return part;
}

SceneRecipe make_shape_recipe(const std::string& name) {
  constexpr double size = 0.05;
  SceneRecipe recipe;
  recipe.id = name;
  RecipePart part;
  part.name = "stone";
  part.mesh = name == "plane" ? make_plane(2 * size, 16) : make_cavity(0.6 * size, size, 80);
  StoneParameters stone;
  stone.scale = 0.4 * size;
  stone.body = {0.85, 0.82, 0.76};
  stone.cloud = {0.75, 0.66, 0.55};
  stone.vein = {0.35, 0.20, 0.12};
  part.texture =
      std::make_shared<TexelArray>(bake_solid(part.mesh, 320, 320, solid_stone(stone), stone.body));
  part.medium = Medium{Rgb(0.02 * size), 0.3, 1.5};
  recipe.parts.push_back(std::move(part));
  recipe.camera.name = "study";
  recipe.camera.position = name == "plane" ? Vec3(0.05, -0.1, 0.15) : Vec3(0.1, 0.1, 0.2);
  recipe.camera.direction = glm::normalize(-recipe.camera.position);
  recipe.title =
      name == "plane" ? "A plane of veined stone" : "A ball-shaped cavity in a cube of veined stone";
  recipe.options = {
      {"integrator", "surface"}, {"model", "composite:view"}, {"size", "256x256"}, {"spp", "64"}};
  return recipe;
}

}  // namespace

SceneRecipe make_demo_recipe() {
  SceneRecipe recipe;
  recipe.id = "demo";
  recipe.title = "A lotus bowl of veined alabaster, lit from behind, and a jade pebble";
  recipe.parts.push_back(bowl());
  recipe.parts.push_back(pebble());
  recipe.parts.push_back(backdrop());
  recipe.camera.name = "demo";
  recipe.camera.position = {0.10, 0.17, 0.52};
  recipe.camera.direction = glm::normalize(Vec3(0.028, 0.055, 0) - recipe.camera.position);
  recipe.camera.vertical_fov = 25;
  // The key, four lamps side by side, comes from behind and above: it falls into the bowl and shines through
  // the wall on our side. Fill from the front right.
  const Vec3 key{-0.32, 0.55, -0.55};
  for (const Vec3 offset :
       {Vec3(0.05, 0, 0), Vec3(-0.05, 0.01, 0), Vec3(0, 0.05, 0.03), Vec3(0, -0.05, -0.03)})
    recipe.lights.push_back(PointLight{key + offset, Rgb(0.66, 0.59, 0.52)});
  recipe.sky.ambient = Rgb(0.13, 0.15, 0.19);
  recipe.sky.key = Rgb(1.1, 1.05, 1.0);
  recipe.sky.exponent = 2;
  recipe.sky.direction = {0.8, 0.6, 0.45};
  recipe.options = {
      {"integrator", "surface"}, {"model", "composite:view"}, {"size", "720x480"}, {"spp", "192"}};
  return recipe;
}

const std::vector<std::string>& recipe_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result{"demo", "plane", "cavity"};
    const auto meshes = expand_scene_ids({"mesh"});
    result.insert(result.end(), meshes.begin(), meshes.end());
    return result;
  }();
  return names;
}

SceneRecipe make_recipe(const std::string& name) {
  if (name == "demo") return make_demo_recipe();
  if (name == "plane" || name == "cavity") return make_shape_recipe(name);
  const auto& names = recipe_names();
  if (std::find(names.begin(), names.end(), name) != names.end()) return make_mesh_study_recipe(name);
  std::string known;
  for (const std::string& each : names) known += ", " + each;
  for (const std::string& each : pattern_names()) known += ", " + each;
  throw InputError("'" + name + "': nothing procedural has that name; known are all, scenes, textures" +
                   known);
}

}  // namespace alabaster
