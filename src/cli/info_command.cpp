#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "cli/commands.h"
#include "scene/scene_file.h"

namespace alabaster {

namespace {

using nlohmann::json;

json triple(const Vec3& v) {
  return {v.x, v.y, v.z};
}
json triple(const Rgb& c) {
  return {c.r, c.g, c.b};
}

Vec3 extent(const BoundingBox& box) {
  return box.empty() ? Vec3(0) : box.high - box.low;
}

const char* alpha_mode_name(AlphaMode mode) {
  return mode == AlphaMode::mask ? "MASK" : mode == AlphaMode::blend ? "BLEND" : "OPAQUE";
}

/// Distinct textures the materials use, by role.
std::map<std::string, const Texture*> textures_of(const Material& material) {
  std::map<std::string, const Texture*> textures{{"base_colour", material.base_colour.get()},
                                                 {"metallic_roughness", material.metallic_roughness.get()},
                                                 {"normal", material.normal.get()},
                                                 {"emissive", material.emissive.get()},
                                                 {"subsurface_map", material.subsurface_map.get()}};
  if (material.medium && material.albedo.texture != material.base_colour)
    textures["albedo"] = material.albedo.texture.get();
  std::erase_if(textures, [](const auto& entry) { return entry.second == nullptr; });
  return textures;
}

/// The media that one object's triangles have, without repeats.
std::vector<Medium> media_of(const Scene& scene, const SceneObject& object) {
  std::vector<Medium> media;
  for (const uint16_t m : std::set<uint16_t>(object.mesh.materials.begin(), object.mesh.materials.end())) {
    const auto& medium = scene.materials[m].medium;
    if (medium && std::find(media.begin(), media.end(), *medium) == media.end()) media.push_back(*medium);
  }
  return media;
}

json describe_object(const Scene& scene, const SceneObject& object) {
  json result{{"name", object.name},
              {"triangles", object.mesh.triangle_count()},
              {"vertices", object.mesh.positions.size()},
              {"closed", object.report.closed},
              {"components", object.report.components},
              {"border_edges", object.report.border_edges},
              {"non_manifold_edges", object.report.non_manifold_edges},
              {"degenerate_triangles", object.report.degenerate_triangles},
              {"duplicate_triangles", object.report.duplicate_triangles},
              {"flipped_triangles", object.report.flipped_triangles},
              {"uv_sets", object.mesh.uv_sets.size()},
              {"vertex_colours", !object.mesh.colours.empty()},
              {"size", triple(extent(object.bounds))},
              {"area", surface_area(object.mesh)},
              {"materials", json::array()},
              {"media", json::array()}};
  if (object.report.closed) result["volume"] = enclosed_volume(object.mesh);
  if (!object.mesh.uv_sets.empty()) {
    const UvAtlas atlas = object.atlas.empty() ? UvAtlas(object.mesh, 0) : object.atlas;
    result["uv"] = {{"charts", atlas.chart_count()},
                    {"overlap_fraction", atlas.overlap_fraction},
                    {"zero_area_triangles", atlas.zero_area_triangles},
                    {"out_of_range_corners", atlas.out_of_range_corners}};
  }
  for (const uint16_t m : std::set<uint16_t>(object.mesh.materials.begin(), object.mesh.materials.end()))
    result["materials"].push_back(scene.materials[m].name);
  for (const Medium& medium : media_of(scene, object)) {
    const Vec3 size = extent(object.bounds);
    const double mean_free_path = medium.mean_free_path.max();
    result["media"].push_back({{"mean_free_path", triple(medium.mean_free_path)},
                               {"size_in_mean_free_paths", triple(size / mean_free_path)}});
  }
  return result;
}

json describe_material(const Material& material) {
  json result{{"name", material.name},
              {"reason", material.medium_reason},
              {"medium", nullptr},
              {"alpha_mode", alpha_mode_name(material.alpha_mode)},
              {"metallic", material.metallic_factor},
              {"roughness", material.roughness_factor},
              {"ior", material.ior},
              {"emission", triple(material.emission)},
              {"double_sided", material.double_sided},
              {"textures", json::object()}};
  if (material.medium)
    result["medium"] = {{"mean_free_path", triple(material.medium->mean_free_path)},
                        {"g", material.medium->g},
                        {"eta", material.medium->eta},
                        {"mean_albedo", material.mean_albedo ? triple(*material.mean_albedo) : json()}};
  for (const auto& [role, texture] : textures_of(material))
    result["textures"][role] = {{"width", texture->texels().width},
                                {"height", texture->texels().height},
                                {"uv_set", texture->mapping().uv_set}};
  return result;
}

std::map<std::string, std::size_t> count_lights(const Scene& scene) {
  static constexpr const char* names[] = {"point", "spot",  "directional",
                                          "disk",  "patch", "emissive_triangles"};
  std::map<std::string, std::size_t> counts;
  for (const Light& light : scene.lights) ++counts[names[light.index()]];
  return counts;
}

json describe(const Scene& scene) {
  json result{{"file", scene.name},
              {"meshes", scene.mesh_count},
              {"textures", scene.texture_count},
              {"size", triple(extent(scene.bounds))},
              {"diagonal", scene.bounds.diagonal()},
              {"objects", json::array()},
              {"materials", json::array()},
              {"cameras", json::array()},
              {"lights", count_lights(scene)},
              {"environment", scene.environment != nullptr},
              {"warnings", scene.warnings}};
  std::size_t triangles = 0;
  for (const SceneObject& object : scene.objects) {
    triangles += object.mesh.triangle_count();
    result["objects"].push_back(describe_object(scene, object));
  }
  result["triangles"] = triangles;
  for (const Material& material : scene.materials) result["materials"].push_back(describe_material(material));
  for (const Camera& camera : scene.cameras) result["cameras"].push_back(camera.name);
  return result;
}

std::string plural(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}
std::string length_text(double metres) {
  if (metres >= 1) return fmt::format("{:.3g} m", metres);
  if (metres >= 0.01) return fmt::format("{:.3g} cm", 100 * metres);
  return fmt::format("{:.3g} mm", 1000 * metres);
}
std::string size_text(const Vec3& size) {
  return fmt::format("{} x {} x {}", length_text(size.x), length_text(size.y), length_text(size.z));
}
std::string path_text(const Rgb& path) {
  if (path.is_grey()) return length_text(path.r);
  return fmt::format("{} / {} / {}", length_text(path.r), length_text(path.g), length_text(path.b));
}

std::string albedo_text(const Material& material) {
  if (!material.mean_albedo) return "unknown until its profile is baked, as the first render does";
  return fmt::format("{:.6f} / {:.6f} / {:.6f}", material.mean_albedo->r, material.mean_albedo->g,
                     material.mean_albedo->b);
}

void print_object(const Scene& scene, const SceneObject& object) {
  const MeshReport& report = object.report;
  fmt::print("  {}: {}, {}, {}\n", object.name, plural(object.mesh.triangle_count(), "triangle", "triangles"),
             report.closed ? "closed" : fmt::format("open ({} border edges)", report.border_edges),
             plural(report.components, "part", "parts"));
  fmt::print("    size {}", size_text(extent(object.bounds)));
  for (const Medium& medium : media_of(scene, object)) {
    const Vec3 size = extent(object.bounds) / medium.mean_free_path.max();
    fmt::print("; {:.3g} x {:.3g} x {:.3g} mean free paths", size.x, size.y, size.z);
  }
  fmt::print("\n");
  if (object.mesh.uv_sets.empty()) {
    fmt::print("    no texture coordinates\n");
  } else {
    const UvAtlas atlas = object.atlas.empty() ? UvAtlas(object.mesh, 0) : object.atlas;
    fmt::print("    {}, {}\n", plural(object.mesh.uv_sets.size(), "UV set", "UV sets"),
               plural(atlas.chart_count(), "chart", "charts"));
  }
}

void print_material(const Material& material) {
  fmt::print("  {}: {}\n", material.name, material.medium_reason);
  if (material.medium)
    fmt::print("    mean free path {}, g {:.3g}, eta {:.3g}, mean albedo {}\n",
               path_text(material.medium->mean_free_path), material.medium->g, material.medium->eta,
               albedo_text(material));
  for (const auto& [role, texture] : textures_of(material))
    fmt::print("    {} {} x {}\n", role, texture->texels().width, texture->texels().height);
}

void print(const Scene& scene) {
  std::size_t triangles = 0;
  for (const SceneObject& object : scene.objects) triangles += object.mesh.triangle_count();
  fmt::print("{}: {}, {}, {}, {}\n", scene.name, plural(scene.mesh_count, "mesh", "meshes"),
             plural(scene.objects.size(), "object", "objects"), plural(triangles, "triangle", "triangles"),
             plural(scene.texture_count, "texture", "textures"));
  fmt::print("size {}, diagonal {}\n", size_text(extent(scene.bounds)), length_text(scene.bounds.diagonal()));
  fmt::print("objects:\n");
  for (const SceneObject& object : scene.objects) print_object(scene, object);
  fmt::print("materials:\n");
  for (const Material& material : scene.materials) print_material(material);
  if (!scene.cameras.empty()) {
    fmt::print("cameras:");
    for (const Camera& camera : scene.cameras) fmt::print(" {}", camera.name);
    fmt::print("\n");
  }
  fmt::print("lights:{}", scene.environment ? " environment" : "");
  for (const auto& [kind, count] : count_lights(scene)) fmt::print(" {} {}", count, kind);
  fmt::print("\n");
  for (const std::string& warning : scene.warnings) fmt::print("warning: {}\n", warning);
}

struct InfoOptions {
  std::string file;
  bool as_json = false;
};

}  // namespace

void add_info_command(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command =
      app.add_subcommand("info", "Describe a model or a scene: meshes, media, sizes, warnings");
  command->add_option("MODEL", options->file, "A .glb, .gltf or scene .json file")->required();
  command->add_flag("--json", options->as_json, "Print JSON on standard output (docs/gltf_support.md)");
  command->callback([options] {
    LoadOptions load;
    load.purpose = Purpose::describe;
    const LoadedScene loaded = load_scene(options->file, load);
    if (options->as_json)
      fmt::print("{}\n", describe(loaded.scene).dump(2, ' ', false, json::error_handler_t::replace));
    else
      print(loaded.scene);
  });
}

}  // namespace alabaster
