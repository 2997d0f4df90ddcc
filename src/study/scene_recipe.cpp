#include "study/scene_recipe.h"

namespace alabaster {

namespace {

Material make_material(const RecipePart& part) {
  Material material;
  material.name = part.name;
  material.base_colour_factor = Vec4(part.colour.r, part.colour.g, part.colour.b, 1);
  if (part.texture) {
    TextureMapping mapping;
    mapping.wrap_u = mapping.wrap_v = part.wrap;
    material.base_colour = std::make_shared<Texture>(part.texture, mapping);
  }
  material.metallic_factor = 0;
  material.roughness_factor = part.roughness;
  material.emission = part.emission;
  material.medium = part.medium;
  if (part.medium) {
    material.albedo.meaning = part.meaning;
    material.albedo.factor = part.colour;
    material.albedo.texture = material.base_colour;
    material.ior = part.medium->eta;
    material.medium_reason = "procedural scene";
  }
  return material;
}

}  // namespace

Scene build_scene(SceneRecipe recipe) {
  Scene scene;
  scene.name = recipe.id;
  for (RecipePart& part : recipe.parts) {
    scene.materials.push_back(make_material(part));
    SceneObject object;
    object.name = part.name;
    object.mesh = std::move(part.mesh);
    object.mesh.materials.assign(object.mesh.triangle_count(),
                                 static_cast<uint16_t>(scene.materials.size() - 1));
    scene.objects.push_back(std::move(object));
  }
  scene.lights = std::move(recipe.lights);
  prepare_scene(scene);
  scene.environment = make_sky_environment(recipe.sky);
  scene.environment_visible = recipe.sky_visible;
  scene.cameras = {recipe.camera};
  return scene;
}

}  // namespace alabaster
