#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/half_edge_mesh.h"
#include "geometry/mesh.h"
#include "geometry/ray_scene.h"
#include "geometry/uv_atlas.h"
#include "scene/camera.h"
#include "scene/lights.h"
#include "scene/medium.h"
#include "texture/albedo_field.h"
#include "texture/texture.h"

namespace alabaster {

enum class AlphaMode { opaque, mask, blend };

/// glTF's metallic-roughness material, and the medium below the surface if it has one.
struct Material {
  std::string name;
  Vec4 base_colour_factor{1};
  std::shared_ptr<const Texture> base_colour;
  double metallic_factor = 1, roughness_factor = 1;
  std::shared_ptr<const Texture> metallic_roughness;  // G roughness, B metallic
  std::shared_ptr<const Texture> normal;
  double normal_scale = 1;
  Rgb emission;  // factor x strength, W/(sr m^2)
  std::shared_ptr<const Texture> emissive;
  AlphaMode alpha_mode = AlphaMode::opaque;
  double alpha_cutoff = 0.5;
  bool double_sided = false;
  double ior = 1.5;
  double transmission = 0;

  std::optional<Medium> medium;    // none: an opaque surface. A medium of albedo 0 is absorbing glass
  AlbedoSource albedo;             // read where there is a medium
  std::optional<Rgb> mean_albedo;  // of the medium over the texture; set by prepare_scene
  std::string medium_reason;       // why it became a medium or not, for `info`
  std::shared_ptr<const Texture> density_map;     // R: share of the medium's sigma_t, 0 to 1
  std::shared_ptr<const Texture> subsurface_map;  // R: 0 plain diffuse .. 1 subsurface
};

/// A texture at a point of a mesh, in the UV set the texture names; white where there is none.
Vec4 texture_value(const std::shared_ptr<const Texture>& texture, const TriangleMesh& mesh, uint32_t triangle,
                   Vec2 barycentric);

/// Emitted radiance of a point by its material: factor x texture.
Rgb emission(const Material& material, const TriangleMesh& mesh, uint32_t triangle, Vec2 barycentric);

/// Opacity of a point by glTF's alpha mode: 1 when opaque, 0 or 1 when masked.
double opacity(const Material& material, const TriangleMesh& mesh, uint32_t triangle, Vec2 barycentric);

/// One node's mesh: what light inside a medium may travel through.
struct SceneObject {
  std::string name;
  TriangleMesh mesh;
  UvAtlas atlas;
  MeshReport report;
  /// Index into Scene::materials is mesh.materials[triangle].
  std::unique_ptr<AlbedoField> albedo;   // set when any material of the object has a medium
  std::unique_ptr<AlbedoField> density;  // share of sigma_t in r; set when any material has a density map
  BoundingBox bounds;
  Vec3 bounding_centre{0};  // sphere around the mesh
  double bounding_radius = 0;
};

/// Everything a renderer reads; immutable once prepared.
struct Scene {
  std::string name;
  std::vector<SceneObject> objects;
  std::vector<Material> materials;
  std::vector<Light> lights;
  std::unique_ptr<Environment> environment;
  bool environment_visible = true;
  std::vector<Camera> cameras;  // the first is used unless one is named
  RayScene rays;                // object ids are indices into objects
  BoundingBox bounds;
  std::vector<std::string> warnings;
  std::size_t mesh_count = 0, texture_count = 0;  // of the model's file

  const Material& material(const Hit& hit) const {
    return materials[objects[hit.object].mesh.materials[hit.triangle]];
  }
};

/// What a scene is loaded for: where it is only described nothing is baked, an albedo whose profile would
/// have to be stays unknown, and pyramids over space are not built.
enum class Purpose { render, describe };

/// Cleans the meshes, builds atlases, albedo fields, bounds, emissive-triangle lights and the ray scene, and
/// adds warnings. Call once when objects, materials and lights stand. Throws InputError when nothing is left
/// to render.
void prepare_scene(Scene& scene, Purpose purpose = Purpose::render);

}  // namespace alabaster
