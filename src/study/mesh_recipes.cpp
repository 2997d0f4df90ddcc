#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "geometry/shapes.h"
#include "geometry/uv_atlas.h"
#include "study/scene_recipe.h"
#include "study/scene_sets.h"
#include "texture/solid_texture.h"

namespace alabaster {

namespace {

/// Half the largest extent of every object, m.
constexpr double half_extent = 0.05;

/// A shape in mean free paths; scaled to metres afterwards.
struct StudyShape {
  std::string id;
  TriangleMesh mesh;
  double mean_free_path;  // m; the mesh comes in metres already
  Vec3 view;              // from the object towards the camera
  bool back_lit = false;
};

StudyShape blob_shape(int resolution) {
  return {"blob", make_blob(0.8 * half_extent, 0.2, resolution), 0.08 * half_extent, Vec3(0, 0.15, 1)};
}

StudyShape make_shape(const std::string& id) {
  constexpr double size = half_extent;
  const auto number = [&](const char* prefix) { return std::stod(id.substr(std::string(prefix).size())); };
  const Vec3 front(0, 0.15, 1), above(0.25, 0.75, 1);
  const auto starts_with = [&](const char* prefix) { return id.rfind(prefix, 0) == 0; };
  if (starts_with("sphere_")) return {id, make_sphere(size, 96), size / number("sphere_"), front};
  if (starts_with("cylinder_")) {
    const double mean_free_path = size / (2 * number("cylinder_"));
    return {id, make_cylinder(size / 2, 2 * size, 96), mean_free_path, above};
  }
  if (id == "torus") return {id, make_torus(0.75 * size, 0.25 * size, 144), size / 12, above};
  if (starts_with("ellipsoid_"))
    return {id, make_ellipsoid({size, size / 3, size / 3}, 96), size / (3 * number("ellipsoid_")), front};
  if (id == "blob") return blob_shape(144);
  if (id == "fold") {
    const double mean_free_path = size / 10;
    return {id,
            make_folded_sheet(2 * size, 2 * mean_free_path, 0.5 * mean_free_path, 32),
            mean_free_path,
            {-0.8, 0.55, 1}};
  }
  if (starts_with("slab_")) {
    const double mean_free_path = size / 10;
    return {
        id, make_slab(2 * size, number("slab_") * mean_free_path, 36), mean_free_path, {0.25, 1.2, 1}, true};
  }
  throw InputError("scene '" + id + "': is not a mesh scene; known are those of expand_scene_ids(\"mesh\")");
}

/// Side of a square texture with at least `per_length` texels per `length` of surface where the UVs are
/// densest in the mean: a power of two within [256, 2048].
int texture_side(const TriangleMesh& mesh, double length, double per_length) {
  const UvAtlas atlas(mesh);
  double weighted = 0, area = 0;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    weighted += mesh.area(t) * atlas.uv_per_metre(t);
    area += mesh.area(t);
  }
  const double wanted = per_length / (length * weighted / area);
  return static_cast<int>(std::clamp(std::exp2(std::ceil(std::log2(wanted))), 256.0, 2048.0));
}

/// A camera that sees the whole bounding sphere from direction `view`.
Camera framing(const BoundingBox& box, const Vec3& view) {
  Camera camera;
  camera.name = "study";
  camera.vertical_fov = 39.6;
  const double distance = 0.5 * box.diagonal() / std::sin(camera.vertical_fov * pi / 360);
  const Vec3 towards = glm::normalize(view);
  camera.position = box.centre() + distance * towards;
  camera.direction = -towards;
  return camera;
}

SceneRecipe recipe_of(StudyShape shape) {
  const std::string& id = shape.id;
  const BoundingBox box = bounding_box(shape.mesh);
  const Vec3 extent = box.high - box.low;
  const double period = std::max(shape.mean_free_path, std::max({extent.x, extent.y, extent.z}) / 20);
  const int side = texture_side(shape.mesh, period, 12);

  SceneRecipe recipe;
  recipe.id = id;
  for (const StudyScene& scene : study_scenes())
    if (scene.id == id) recipe.title = scene.title;
  RecipePart part;
  part.name = "stone";
  part.medium = Medium{Rgb(shape.mean_free_path), 0.3, 1.5};
  part.texture = std::make_shared<TexelArray>(
      bake_solid(shape.mesh, side, side, solid_stripes({2, 3, 1}, period), Rgb(0.5)));
  part.meaning = AlbedoSource::Meaning::albedo;
  part.roughness = 0.3;
  part.mesh = std::move(shape.mesh);
  recipe.parts.push_back(std::move(part));
  recipe.camera = framing(box, shape.view);
  if (shape.back_lit) recipe.sky.direction = {-0.5, -0.75, -0.3};
  recipe.options = {
      {"integrator", "surface"}, {"model", "composite:view"}, {"size", "256x256"}, {"spp", "64"}};
  return recipe;
}

}  // namespace

SceneRecipe make_mesh_study_recipe(const std::string& id) {
  return recipe_of(make_shape(id));
}

SceneRecipe make_blob_recipe(std::size_t triangles, bool textured) {
  const auto edges = std::max<long>(1, std::lround(std::sqrt(static_cast<double>(triangles) / 12)));
  SceneRecipe recipe = recipe_of(blob_shape(static_cast<int>(4 * edges)));
  if (!textured) {
    recipe.parts.front().texture.reset();
    recipe.parts.front().colour = Rgb(0.9);
  }
  return recipe;
}

}  // namespace alabaster
