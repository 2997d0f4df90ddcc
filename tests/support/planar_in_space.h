#pragma once

#include <glm/gtc/matrix_transform.hpp>

#include "integrators/planar_scene.h"
#include "study/scene_recipe.h"

/// Where the plane of a flat scene lies in space: rotated, scaled by 0.03 and moved.
struct Place {
  double scale = 0.03;
  alabaster::Mat3 rotation =
      alabaster::Mat3(glm::rotate(alabaster::Mat4(1), 0.9, glm::normalize(alabaster::Vec3(1, 2, -0.5))));
  alabaster::Vec3 origin{0.4, -1.1, 2.3};

  alabaster::Vec3 point(alabaster::Vec3 p) const { return origin + scale * (rotation * p); }
};

/// A flat scene as a scene in space: its medium and texture on `sheet`, a piece of the plane z = 0 with the
/// texture's coordinates, its light as a patch and its view straight down.
inline alabaster::Scene planar_in_space(const alabaster::PlanarScene& planar, alabaster::TriangleMesh sheet,
                                        const Place& place = {}) {
  using namespace alabaster;
  SceneRecipe recipe;
  recipe.id = "sheet";
  RecipePart part;
  part.name = "sheet";
  part.mesh = std::move(sheet);
  for (Vec3& p : part.mesh.positions) p = place.point(p);
  for (Vec3f& n : part.mesh.normals) n = Vec3f(place.rotation * Vec3(n));
  part.medium = planar.medium;
  part.medium->mean_free_path *= place.scale;
  part.texture = planar.albedo;
  part.meaning = AlbedoSource::Meaning::albedo;
  part.roughness = 0;
  recipe.parts.push_back(part);
  recipe.sky.ambient = recipe.sky.key = Rgb(0);
  recipe.lights.push_back(PatchLight{place.origin, planar.light.radius * place.scale, Rgb(1)});
  recipe.camera.position = place.point(Vec3(0, 0, 3));
  recipe.camera.direction = place.rotation * Vec3(0, 0, -1);
  recipe.camera.up = place.rotation * Vec3(0, 1, 0);
  recipe.camera.orthographic_height = planar.view.size.y * place.scale;
  return build_scene(std::move(recipe));
}
