#include "scene/gltf_materials.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "scene/gltf_textures.h"

namespace alabaster {

namespace {

using tinygltf::Value;

TextureReference reference_of(int index, int set, const tinygltf::ExtensionMap& extensions) {
  // The common form of a texture reference is that of extensions: rebuild it as such.
  if (index < 0) return {};
  Value::Object object{{"index", Value(index)}, {"texCoord", Value(std::max(set, 0))}};
  if (!extensions.empty())
    object.emplace("extensions", Value(Value::Object(extensions.begin(), extensions.end())));
  return texture_reference(Value(std::move(object)));
}

template <typename Info>
TextureReference reference_of(const Info& info) {
  return reference_of(info.index, info.texCoord, info.extensions);
}

Rgb rgb_of(const std::vector<double>& values, const Rgb& fallback) {
  return values.size() >= 3 ? Rgb(values[0], values[1], values[2]) : fallback;
}

double number_of(const Value& object, const char* key, double fallback) {
  if (!object.IsObject() || !object.Has(key)) return fallback;
  const Value& value = object.Get(key);
  return value.IsNumber() ? value.GetNumberAsDouble() : fallback;
}

std::optional<Rgb> colour_of(const Value& object, const char* key) {
  if (!object.IsObject() || !object.Has(key)) return std::nullopt;
  const Value& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() < 3) return std::nullopt;
  return Rgb(value.Get(0).GetNumberAsDouble(), value.Get(1).GetNumberAsDouble(),
             value.Get(2).GetNumberAsDouble());
}

const Value& extension(const tinygltf::Material& material, const char* name) {
  static const Value none;
  const auto it = material.extensions.find(name);
  return it == material.extensions.end() ? none : it->second;
}

/// First of several spellings.
const Value& member(const Value& object, std::initializer_list<const char*> names) {
  static const Value none;
  for (const char* name : names)
    if (object.IsObject() && object.Has(name)) return object.Get(name);
  return none;
}

/// KHR_materials_volume_scatter or KHR_materials_scatter, whichever is there.
const Value& scatter_extension(const tinygltf::Material& material) {
  const Value& older = extension(material, "KHR_materials_volume_scatter");
  return older.IsObject() ? older : extension(material, "KHR_materials_scatter");
}

TextureReference multiscatter_texture(const Value& scatter) {
  return texture_reference(member(scatter, {"multiscatterColorTexture"}));
}

class MaterialReader {
 public:
  MaterialReader(const GltfDocument& document, GltfTextures& textures, std::vector<std::string>& warnings)
      : document_(document), textures_(textures), warnings_(warnings) {}

  Material read(const tinygltf::Material& source, std::size_t index, std::size_t primary) {
    primary_ = primary;
    place_ = gltf_place("materials", index, source.name);
    Material material;
    material.name = source.name.empty() ? fmt::format("material {}", index) : source.name;
    read_surface(source, material);
    read_alpha(source, material);
    read_extensions(source, material);
    read_medium(source, material);
    check(material);
    return material;
  }

 private:
  void read_surface(const tinygltf::Material& source, Material& material) {
    const auto& pbr = source.pbrMetallicRoughness;
    if (pbr.baseColorFactor.size() >= 4)
      material.base_colour_factor = {pbr.baseColorFactor[0], pbr.baseColorFactor[1], pbr.baseColorFactor[2],
                                     pbr.baseColorFactor[3]};
    material.base_colour = load(reference_of(pbr.baseColorTexture), Encoding::srgb);
    material.metallic_factor = pbr.metallicFactor;
    material.roughness_factor = pbr.roughnessFactor;
    material.metallic_roughness = load(reference_of(pbr.metallicRoughnessTexture), Encoding::linear);
    material.normal = load(reference_of(source.normalTexture), Encoding::linear);
    material.normal_scale = source.normalTexture.scale;
    material.emission = rgb_of(source.emissiveFactor, Rgb(0));
    if (!material.emission.is_black())
      material.emissive = load(reference_of(source.emissiveTexture), Encoding::srgb);
    material.double_sided = source.doubleSided;
  }

  void read_alpha(const tinygltf::Material& source, Material& material) {
    material.alpha_cutoff = source.alphaCutoff;
    if (source.alphaMode == "MASK") {
      material.alpha_mode = AlphaMode::mask;
    } else if (source.alphaMode == "BLEND") {
      material.alpha_mode = AlphaMode::blend;
    } else if (source.alphaMode != "OPAQUE") {
      throw InputError(document_.file, place_ + ".alphaMode",
                       "is '" + source.alphaMode + "'; it must be OPAQUE, MASK or BLEND");
    }
  }

  void read_extensions(const tinygltf::Material& source, Material& material) {
    material.ior = number_of(extension(source, "KHR_materials_ior"), "ior", 1.5);
    material.emission *=
        number_of(extension(source, "KHR_materials_emissive_strength"), "emissiveStrength", 1);
    material.transmission =
        number_of(extension(source, "KHR_materials_transmission"), "transmissionFactor", 0);
    if (extension(source, "KHR_materials_unlit").IsObject())
      warnings_.push_back(place_ + ": its unlit look is ignored; it is shaded like any other material");
  }

  void read_medium(const tinygltf::Material& source, Material& material) {
    const Value& volume = extension(source, "KHR_materials_volume");
    const Value& scatter = scatter_extension(source);
    if (scatter.IsObject()) {
      read_scatter(source, volume, scatter, material);
    } else if (volume.IsObject() && material.transmission > 0) {
      read_glass(volume, material);
    } else if (material.transmission > 0) {
      material.medium_reason =
          "opaque: thin-walled transmission (KHR_materials_transmission without a volume)";
      warnings_.push_back(place_ + ": thin-walled transmission is not supported; it is rendered opaque");
    }
  }

  /// sigma_t = -ln(attenuationColor) / attenuationDistance (KHR_materials_volume).
  std::optional<Rgb> extinction(const Value& volume) {
    const Rgb colour = colour_of(volume, "attenuationColor").value_or(Rgb(1));
    const double distance = number_of(volume, "attenuationDistance", std::numeric_limits<double>::infinity());
    Rgb sigma_t;
    for (int c = 0; c < 3; ++c) sigma_t[c] = -std::log(std::clamp(colour[c], 1e-6, 1.0)) / distance;
    if (!(distance > 0) || !sigma_t.is_finite() || sigma_t.max() <= 0) return std::nullopt;
    return sigma_t;
  }

  void set_extinction(const Rgb& sigma_t, Material& material) {
    Medium medium;
    // A channel that is not attenuated at all still needs a finite mean free path.
    for (int c = 0; c < 3; ++c) medium.mean_free_path[c] = 1 / std::max(sigma_t[c], 1e-6 * sigma_t.max());
    medium.eta = std::max(material.ior, 1.0);
    medium.g = 0;
    material.medium = medium;
  }

  void read_scatter(const tinygltf::Material& source, const Value& volume, const Value& scatter,
                    Material& material) {
    const bool older = extension(source, "KHR_materials_volume_scatter").IsObject();
    const char* name = older ? "KHR_materials_volume_scatter" : "KHR_materials_scatter";
    // The older draft's own example leaves thicknessFactor out and means a volume.
    const double thickness = number_of(volume, "thicknessFactor", older ? 1 : 0);
    if (!volume.IsObject() || thickness <= 0) {
      material.medium_reason = fmt::format("opaque: {} on a thin wall", name);
      warnings_.push_back(
          fmt::format("{}: {} without a volume of thicknessFactor above 0 is a thin wall, which is "
                      "not supported; it is rendered opaque",
                      place_, name));
      return;
    }
    const auto sigma_t = extinction(volume);
    if (!sigma_t) {
      material.medium_reason =
          fmt::format("opaque: {}, but its attenuationColor and -Distance mean no medium", name);
      return;
    }
    set_extinction(*sigma_t, material);
    material.medium->g = std::clamp(number_of(scatter, "scatterAnisotropy", 0), -0.99, 0.99);
    AlbedoSource& albedo = material.albedo;
    albedo.meaning = AlbedoSource::Meaning::multiscatter;
    const Value& colour = member(scatter, {"multiscatterColorFactor", "multiscatterColor"});
    albedo.texture = load(multiscatter_texture(scatter), Encoding::srgb);
    // Both drafts multiply texture and factor; a texture alone stands for itself.
    albedo.factor = Rgb(albedo.texture ? 1 : 0);
    if (colour.IsArray() && colour.ArrayLen() >= 3)
      albedo.factor = Rgb(colour.Get(0).GetNumberAsDouble(), colour.Get(1).GetNumberAsDouble(),
                          colour.Get(2).GetNumberAsDouble());
    const Value& strength = member(scatter, {"scatterStrengthFactor", "scatterStrength", "scatterFactor"});
    albedo.strength = strength.IsNumber() ? strength.GetNumberAsDouble() : 1;
    albedo.strength_texture = load(
        texture_reference(member(scatter, {"scatterStrengthTexture", "scatterTexture"})), Encoding::linear);
    material.medium_reason = fmt::format("medium: {}", name);
  }

  void read_glass(const Value& volume, Material& material) {
    if (number_of(volume, "thicknessFactor", 0) <= 0) {
      material.medium_reason =
          "opaque: thin-walled transmission (KHR_materials_volume with thicknessFactor 0)";
      warnings_.push_back(place_ + ": thin-walled transmission is not supported; it is rendered opaque");
      return;
    }
    // Clear glass still refracts: a medium that hardly absorbs, 1000 km per mean free path.
    const auto sigma_t = extinction(volume);
    set_extinction(sigma_t.value_or(Rgb(1e-6)), material);
    material.albedo = {AlbedoSource::Meaning::albedo, Rgb(0), nullptr, false, 1, nullptr};
    material.medium_reason = sigma_t ? "glass: KHR_materials_volume absorbs and does not scatter"
                                     : "glass: KHR_materials_volume without attenuation, clear";
  }

  void check(Material& material) {
    const auto bad = [&](const char* what) {
      throw InputError(document_.file, place_,
                       std::string(what) + " is not a finite number; export it again");
    };
    for (int c = 0; c < 4; ++c)
      if (!std::isfinite(material.base_colour_factor[c])) bad("its base colour");
    if (!std::isfinite(material.metallic_factor + material.roughness_factor))
      bad("its metallic or roughness");
    if (!material.emission.is_finite()) bad("its emission");
    if (!std::isfinite(material.ior) || material.ior < 1) material.ior = material.ior == 0 ? 1e4 : 1.5;
    material.roughness_factor = std::clamp(material.roughness_factor, 0.0, 1.0);
    material.metallic_factor = std::clamp(material.metallic_factor, 0.0, 1.0);
    for (int c = 0; c < 3; ++c) material.emission[c] = std::max(material.emission[c], 0.0);
  }

  std::shared_ptr<const Texture> load(const TextureReference& reference, Encoding encoding) {
    return textures_.load(reference, encoding, primary_);
  }

  const GltfDocument& document_;
  GltfTextures& textures_;
  std::vector<std::string>& warnings_;
  std::size_t primary_ = 0;
  std::string place_;
};

std::size_t primary_set(const tinygltf::Material& material) {
  const TextureReference scatter = multiscatter_texture(scatter_extension(material));
  if (scatter) return scatter.uv_set;
  const TextureReference base = reference_of(material.pbrMetallicRoughness.baseColorTexture);
  return base ? base.uv_set : 0;
}

}  // namespace

GltfMaterials read_materials(const GltfDocument& document) {
  GltfMaterials result;
  GltfTextures textures(document);
  MaterialReader reader(document, textures, result.warnings);
  const auto& sources = document.model->materials;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    result.primary_uv_set.push_back(primary_set(sources[i]));
    result.materials.push_back(reader.read(sources[i], i, result.primary_uv_set.back()));
  }
  Material fallback;
  fallback.name = "default";
  fallback.metallic_factor = 0;  // glTF's default material would be a metal; nobody who names none wants that
  result.materials.push_back(std::move(fallback));
  result.primary_uv_set.push_back(0);
  return result;
}

}  // namespace alabaster
