#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "core/rng.h"
#include "geometry/spatial_order.h"
#include "scene/albedo.h"

namespace alabaster {

Vec4 texture_value(const std::shared_ptr<const Texture>& texture, const TriangleMesh& mesh, uint32_t triangle,
                   Vec2 barycentric) {
  if (!texture) return Vec4(1);
  return texture->evaluate(mesh.uv(triangle, barycentric, texture->mapping().uv_set));
}

Rgb emission(const Material& material, const TriangleMesh& mesh, uint32_t triangle, Vec2 barycentric) {
  if (!material.emissive) return material.emission;
  const Vec4 t = texture_value(material.emissive, mesh, triangle, barycentric);
  return material.emission * Rgb(t.r, t.g, t.b);
}

double opacity(const Material& material, const TriangleMesh& mesh, uint32_t triangle, Vec2 barycentric) {
  if (material.alpha_mode == AlphaMode::opaque) return 1;
  double alpha =
      material.base_colour_factor.a * texture_value(material.base_colour, mesh, triangle, barycentric).a;
  if (!mesh.colours.empty()) {
    const Index3& corner = mesh.attributes[triangle];
    alpha *= (1 - barycentric.x - barycentric.y) * mesh.colours[corner[0]].a +
             barycentric.x * mesh.colours[corner[1]].a + barycentric.y * mesh.colours[corner[2]].a;
  }
  if (material.alpha_mode == AlphaMode::mask) return alpha >= material.alpha_cutoff ? 1 : 0;
  return std::clamp(alpha, 0.0, 1.0);
}

namespace {

/// Meshes of fewer triangles are kept as they come: the caches hold them in any order.
constexpr std::size_t large_mesh = 1 << 17;

/// `random` of a ray serves all layers it meets: mixed with the triangle it becomes a number per layer.
double random_of_layer(double random, uint32_t object, uint32_t triangle) {
  if (random == 0) return 0;  // no random number given: everything that is there at all counts
  const uint64_t bits =
      hash_combine(std::bit_cast<uint64_t>(random), (static_cast<uint64_t>(object) << 32) | triangle);
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

HitFilter opacity_filter(const Scene& scene, uint32_t index) {
  const SceneObject* object = &scene.objects[index];
  const Material* materials = scene.materials.data();
  const bool transparent =
      std::any_of(object->mesh.materials.begin(), object->mesh.materials.end(),
                  [&](uint16_t m) { return materials[m].alpha_mode != AlphaMode::opaque; });
  if (!transparent) return {};
  return [object, materials, index](uint32_t triangle, Vec2 barycentric, double random) {
    const Material& material = materials[object->mesh.materials[triangle]];
    if (material.alpha_mode == AlphaMode::opaque) return true;
    return random_of_layer(random, index, triangle) < opacity(material, object->mesh, triangle, barycentric);
  };
}

void set_bounds(SceneObject& object) {
  object.bounds = bounding_box(object.mesh);
  object.bounding_centre = object.bounds.centre();
  double squared = 0;
  for (const Vec3& p : object.mesh.positions)
    squared = std::max(squared, length_squared(p - object.bounding_centre));
  object.bounding_radius = std::sqrt(squared);
}

bool has_medium(const Scene& scene, const SceneObject& object) {
  return std::any_of(object.mesh.materials.begin(), object.mesh.materials.end(),
                     [&](uint16_t m) { return scene.materials[m].medium.has_value(); });
}

void warn_about_mesh(const SceneObject& object, bool medium, std::vector<std::string>& warnings) {
  const MeshReport& report = object.report;
  const auto add = [&](std::size_t count, const char* text) {
    if (count > 0) warnings.push_back(fmt::format("object '{}': {} {}", object.name, count, text));
  };
  add(report.degenerate_triangles, "triangles without area are left out");
  add(report.duplicate_triangles, "triangles that repeat another are left out");
  add(report.non_manifold_edges, "edges are shared by more than two triangles");
  add(report.flipped_triangles, "triangles were turned over to agree with their neighbours");
  if (medium && !report.closed)
    warnings.push_back(
        fmt::format("object '{}' is open ({} border edges): light inside it has no back side to meet",
                    object.name, report.border_edges));
}

void warn_about_uvs(const SceneObject& object, std::vector<std::string>& warnings) {
  const UvAtlas& atlas = object.atlas;
  const auto add = [&](std::size_t count, const char* text) {
    if (count > 0) warnings.push_back(fmt::format("object '{}': {} {}", object.name, count, text));
  };
  add(atlas.zero_area_triangles, "triangles have no area in UV");
  if (atlas.overlap_fraction > 0.01)
    warnings.push_back(fmt::format("object '{}': {:.0f} % of its texture is used more than once", object.name,
                                   100 * atlas.overlap_fraction));
}

void add_emissive_triangles(Scene& scene) {
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const TriangleMesh& mesh = scene.objects[o].mesh;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      if (!scene.materials[mesh.materials[t]].emission.is_black())
        scene.lights.push_back(TriangleLight{static_cast<uint32_t>(o), static_cast<uint32_t>(t)});
  }
}

/// Textured media of this object need UVs.
bool reads_albedo_texture(const Scene& scene, const SceneObject& object) {
  return std::any_of(object.mesh.materials.begin(), object.mesh.materials.end(), [&](uint16_t m) {
    const Material& material = scene.materials[m];
    return material.medium && material.albedo.texture;
  });
}

/// Beyond these, squares and densities leave the range of single precision.
void check_size(const Scene& scene) {
  constexpr double smallest = 1e-15, largest = 1e15;  // m
  const double diagonal = scene.bounds.diagonal();
  if (!(diagonal >= smallest && diagonal <= largest))
    throw InputError(scene.name,
                     fmt::format("is {:.3g} m across, outside {:g} to {:g}; check the scale of its "
                                 "nodes and positions",
                                 diagonal, smallest, largest));
}

}  // namespace

void prepare_scene(Scene& scene, Purpose purpose) {
  for (SceneObject& object : scene.objects) {
    object.report = clean_mesh(object.mesh);
    if (object.mesh.triangle_count() >= large_mesh) sort_in_space(object.mesh);
  }
  std::erase_if(scene.objects, [&](const SceneObject& object) {
    if (object.mesh.triangle_count() > 0) return false;
    scene.warnings.push_back(
        fmt::format("object '{}' has no triangle with an area and is left out", object.name));
    return true;
  });
  if (scene.objects.empty())
    throw InputError(scene.name, "has no triangles to render; check that its scene holds a mesh");
  for (SceneObject& object : scene.objects) {
    set_bounds(object);
    scene.bounds.extend(object.bounds);
    const bool medium = has_medium(scene, object);
    warn_about_mesh(object, medium, scene.warnings);
    if (medium) {
      object.atlas = UvAtlas(object.mesh, 0);
      if (reads_albedo_texture(scene, object)) {
        if (object.mesh.uv_sets.empty())
          scene.warnings.push_back(fmt::format(
              "object '{}' has no texture coordinates: its texture is read at one point", object.name));
        else
          warn_about_uvs(object, scene.warnings);
      }
    }
  }
  check_size(scene);
  build_albedo_fields(scene, purpose);
  add_emissive_triangles(scene);
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    scene.rays.add(scene.objects[i].mesh, opacity_filter(scene, static_cast<uint32_t>(i)));
  scene.rays.commit();
}

}  // namespace alabaster
