#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "core/atomic_file.h"
#include "image/png_file.h"
#include "optics/profile_table.h"
#include "scene/gltf_export.h"
#include "study/scene_recipe.h"
#include "texture/patterns.h"

namespace alabaster {

namespace {

using Json = nlohmann::ordered_json;

/// Six digits: what people type, and finer than any of these numbers matters.
double rounded(double value) {
  return std::stod(fmt::format("{:.6g}", value));
}
Json to_json(const Vec3& v) {
  return Json::array({rounded(v.x), rounded(v.y), rounded(v.z)});
}
Json to_json(const Rgb& c) {
  return c.is_grey() ? Json(rounded(c.r)) : Json::array({rounded(c.r), rounded(c.g), rounded(c.b)});
}

/// Indented JSON with arrays of numbers on one line each.
std::string to_text(const Json& json) {
  const std::string indented = json.dump(2);
  std::string text;
  bool in_array = false;
  for (std::size_t k = 0; k < indented.size(); ++k) {
    const char c = indented[k];
    if (c == '[') in_array = indented.find_first_of("{\"", k) > indented.find(']', k);
    if (c == ']') in_array = false;
    const bool layout = c == '\n' || c == ' ';
    if (!in_array || !layout) text += c;
    if (in_array && c == ',') text += ' ';
  }
  return text + "\n";
}

Rgb to_reflectance(const Rgb& albedo) {
  const ProfileTable& profile = baseline_profile();
  return {profile.reflectance(albedo.r), profile.reflectance(albedo.g), profile.reflectance(albedo.b)};
}

/// The same texture as base colour; textures of few tones, so each is looked up once.
std::shared_ptr<const TexelArray> to_reflectance(const TexelArray& albedo) {
  auto result = std::make_shared<TexelArray>(albedo);
  std::map<float, float> known;
  for (Vec4f& texel : result->texels)
    for (int c = 0; c < 3; ++c) {
      const auto [entry, fresh] = known.try_emplace(texel[c], 0.0f);
      if (fresh)
        entry->second = static_cast<float>(baseline_profile().reflectance(static_cast<double>(texel[c])));
      texel[c] = entry->second;
    }
  return result;
}

ExportMaterial export_material(const RecipePart& part) {
  ExportMaterial material;
  material.name = part.name;
  material.wrap = part.wrap;
  material.roughness = part.roughness;
  material.emission = part.emission;
  if (part.medium && part.meaning == AlbedoSource::Meaning::albedo) {
    // Reflectance of a product is not the product of reflectances: factor and texture are never both used.
    material.base_colour = part.texture ? Rgb(1) : to_reflectance(part.colour);
    if (part.texture) material.texture = to_reflectance(*part.texture);
  } else {
    material.base_colour = part.colour;
    material.texture = part.texture;
  }
  return material;
}

Json light_json(const Light& light) {
  return std::visit(
      [](const auto& l) -> Json {
        using T = std::decay_t<decltype(l)>;
        if constexpr (std::is_same_v<T, DirectionalLight>)
          return {{"type", "directional"},
                  {"direction", to_json(l.direction)},
                  {"irradiance", to_json(l.irradiance)}};
        else if constexpr (std::is_same_v<T, PointLight>)
          return {{"type", "point"}, {"position", to_json(l.position)}, {"intensity", to_json(l.intensity)}};
        else if constexpr (std::is_same_v<T, SpotLight>)
          return {{"type", "spot"},
                  {"position", to_json(l.position)},
                  {"direction", to_json(l.direction)},
                  {"intensity", to_json(l.intensity)},
                  {"inner_cone", l.inner_cone * 180 / pi},
                  {"outer_cone", l.outer_cone * 180 / pi}};
        else if constexpr (std::is_same_v<T, DiskLight>)
          return {{"type", "disk"},
                  {"position", to_json(l.position)},
                  {"direction", to_json(l.direction)},
                  {"radius", rounded(l.radius)},
                  {"radiance", to_json(l.radiance)}};
        else if constexpr (std::is_same_v<T, PatchLight>)
          return {{"type", "patch"},
                  {"position", to_json(l.position)},
                  {"radius", rounded(l.radius)},
                  {"radiance", to_json(l.radiance)}};
        else
          return nullptr;  // triangle lights follow from emission
      },
      light);
}

Json scene_json(const SceneRecipe& recipe) {
  Json scene;
  scene["version"] = 1;
  scene["model"] = recipe.id + ".glb";
  scene["camera"] = {{"position", to_json(recipe.camera.position)},
                     {"direction", to_json(recipe.camera.direction)},
                     {"up", to_json(recipe.camera.up)},
                     {"vertical_fov", recipe.camera.vertical_fov}};
  if (!recipe.lights.empty()) {
    scene["lights"] = Json::array();
    for (const Light& light : recipe.lights) scene["lights"].push_back(light_json(light));
  }
  scene["environment"] = {{"sky",
                           {{"ambient", to_json(recipe.sky.ambient)},
                            {"key", to_json(recipe.sky.key)},
                            {"exponent", recipe.sky.exponent},
                            {"direction", to_json(recipe.sky.direction)}}},
                          {"visible", recipe.sky_visible}};
  for (const RecipePart& part : recipe.parts) {
    Json& material = scene["materials"][part.name];
    material["subsurface"] = part.medium.has_value();
    if (!part.medium) continue;
    material["mean_free_path"] = to_json(part.medium->mean_free_path);
    material["g"] = part.medium->g;
    material["eta"] = part.medium->eta;
  }
  for (const auto& [key, text] : recipe.options) {
    // Numbers as numbers, the rest as text.
    const Json parsed = Json::parse(text, nullptr, false);
    scene["integrator"][key] = parsed.is_number() ? parsed : Json(text);
  }
  return scene;
}

}  // namespace

void write_scene_files(const SceneRecipe& recipe, const std::filesystem::path& folder) {
  ExportScene scene;
  std::vector<TriangleMesh> meshes;
  meshes.reserve(recipe.parts.size());
  for (const RecipePart& part : recipe.parts) {
    meshes.push_back(part.mesh);
    meshes.back().materials.assign(part.mesh.triangle_count(), static_cast<uint16_t>(scene.materials.size()));
    scene.objects.push_back({part.name, &meshes.back()});
    scene.materials.push_back(export_material(part));
  }
  write_glb(folder / (recipe.id + ".glb"), scene);
  write_text_atomically(folder / (recipe.id + ".json"), to_text(scene_json(recipe)));
}

void write_pattern_file(const std::string& name, const std::filesystem::path& folder) {
  const TexelArray texels = make_pattern(name);
  Pixels8 pixels(texels.width, texels.height, 3);
  for (int y = 0; y < texels.height; ++y)
    for (int x = 0; x < texels.width; ++x)
      for (int c = 0; c < 3; ++c)
        pixels.at(x, y)[c] =
            static_cast<uint8_t>(std::lround(255 * std::clamp(texels.at(x, y)[c], 0.0f, 1.0f)));
  write_png(folder / (name + ".png"), pixels);
}

}  // namespace alabaster
