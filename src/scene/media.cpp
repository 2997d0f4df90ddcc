#include "scene/media.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "core/error.h"
#include "core/progress.h"
#include "image/image_decode.h"
#include "scene/json_reader.h"
#include "texture/texel_array.h"

namespace alabaster {

namespace {

constexpr double default_relative_mean_free_path = 0.005;

double parse_positive(const std::string& text, const std::string& whole) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != 0 || !(value > 0) || !std::isfinite(value))
    throw InputError(
        "mean free path '" + whole +
        "' is not a length; give metres (0.01), one per channel (0.01,0.005,0.002) or per cent of "
        "the box diagonal (0.5%)");
  return value;
}

Rgb to_metres(const LengthSpecification& length, double diagonal) {
  return length.relative ? length.value * diagonal : length.value;
}

std::shared_ptr<const Texture> load_picture(const std::filesystem::path& path, Encoding encoding) {
  return std::make_shared<Texture>(std::make_shared<TexelArray>(make_texels(read_image(path), encoding)),
                                   TextureMapping{});
}

double mean_metallic(const Material& material) {
  if (!material.metallic_roughness) return material.metallic_factor;
  double sum = 0;
  const auto& texels = material.metallic_roughness->texels().texels;
  for (const Vec4f& t : texels) sum += t.b;
  return material.metallic_factor * sum / static_cast<double>(std::max<std::size_t>(texels.size(), 1));
}

/// What keeps a material from becoming a medium in a bare model; empty when nothing does.
std::string obstacle(const Material& material) {
  if (material.transmission > 0) return "transmission";
  if (material.alpha_mode == AlphaMode::blend) return "alphaMode BLEND";
  if (const double metallic = mean_metallic(material); metallic >= 0.5)
    return fmt::format("mean metallic {:.2g}", metallic);
  return {};
}

void set_albedo_from_base_colour(Material& material) {
  material.albedo = {};
  material.albedo.factor =
      Rgb(material.base_colour_factor.r, material.base_colour_factor.g, material.base_colour_factor.b);
  material.albedo.texture = material.base_colour;
  material.albedo.vertex_colours = true;
}

void set_albedo(Material& material, const MaterialOverride::Colour& colour, AlbedoSource::Meaning meaning) {
  material.albedo = {};
  material.albedo.meaning = meaning;
  if (const auto* path = std::get_if<std::filesystem::path>(&colour)) {
    // A reflectance map is a picture of a colour; an albedo map holds data.
    const bool reflectance = meaning == AlbedoSource::Meaning::reflectance;
    material.albedo.texture = load_picture(*path, reflectance ? Encoding::srgb : Encoding::linear);
  } else {
    material.albedo.factor = std::get<Rgb>(colour);
  }
}

void make_medium(Material& material, const std::string& reason) {
  Medium medium;
  medium.eta = material.ior;
  medium.mean_free_path = Rgb(0);  // filled in below, when all rules have spoken
  material.medium = medium;
  set_albedo_from_base_colour(material);
  material.medium_reason = reason;
}

class Rules {
 public:
  Rules(Scene& scene, const MediumRules& rules, const std::string& file)
      : scene_(scene), rules_(rules), file_(file) {
    for (const SceneObject& object : scene.objects) box_.extend(bounding_box(object.mesh));
  }

  void run() {
    const auto everything = rules_.overrides.find("*");
    std::shared_ptr<const Texture> subsurface_map;
    if (!rules_.subsurface_map.empty())
      subsurface_map = load_picture(rules_.subsurface_map, Encoding::linear);
    for (Material& material : scene_.materials) {
      apply_default(material);
      if (everything != rules_.overrides.end()) apply(material, everything->second, "\"*\"");
      const auto named = rules_.overrides.find(material.name);
      if (named != rules_.overrides.end() && named->first != "*")
        apply(material, named->second, "\"" + material.name + "\"");
      apply_options(material);
      if (!material.medium) continue;
      if (subsurface_map) material.subsurface_map = subsurface_map;
      check(material);
    }
  }

 private:
  void apply_default(Material& material) {
    if (!material.medium_reason.empty()) return;  // an extension has decided
    const std::string hindrance = obstacle(material);
    if (!rules_.default_rule || !rules_.subsurface.empty())
      material.medium_reason = "opaque: not named as subsurface";
    else if (hindrance.empty())
      make_medium(material, "medium: from its base colour, by the default rule");
    else
      material.medium_reason = "opaque: " + hindrance;
  }

  void apply(Material& material, const MaterialOverride& rule, const std::string& key) {
    if (rule.subsurface.has_value() && !*rule.subsurface) {
      material.medium.reset();
      material.medium_reason = "opaque: the scene file's materials " + key + " say so";
    } else if (!material.medium && (rule.subsurface.value_or(false) || rule.albedo || rule.reflectance)) {
      make_medium(material, "medium: the scene file's materials " + key);
    }
    if (rule.roughness) {
      material.roughness_factor = *rule.roughness;
      material.metallic_roughness = nullptr;
    }
    if (!material.medium) return;
    if (rule.reflectance) set_albedo(material, *rule.reflectance, AlbedoSource::Meaning::reflectance);
    if (rule.albedo) set_albedo(material, *rule.albedo, AlbedoSource::Meaning::albedo);
    if (rule.mean_free_path)
      material.medium->mean_free_path = to_metres(*rule.mean_free_path, box_.diagonal());
    if (rule.density) {
      default_length(*material.medium);
      material.medium->mean_free_path /= *rule.density;
    }
    if (rule.density_map) {
      material.density_map = load_picture(*rule.density_map, Encoding::linear);
      scene_.warnings.push_back("material '" + material.name +
                                "': its density picture is read by --integrator volume and walk; surface "
                                "takes the full density everywhere");
    }
    if (rule.g) material.medium->g = *rule.g;
    if (rule.eta) material.medium->eta = *rule.eta;
  }

  void apply_options(Material& material) {
    const auto& names = rules_.subsurface;
    if (!material.medium && std::find(names.begin(), names.end(), material.name) != names.end())
      make_medium(material, "medium: named by --subsurface");
    if (!material.medium) return;
    default_length(*material.medium);
    if (rules_.mean_free_path)
      material.medium->mean_free_path = to_metres(*rules_.mean_free_path, box_.diagonal());
    if (rules_.g) material.medium->g = *rules_.g;
    if (rules_.eta) material.medium->eta = *rules_.eta;
  }

  void default_length(Medium& medium) {
    if (medium.mean_free_path.is_black())
      medium.mean_free_path = Rgb(default_relative_mean_free_path * box_.diagonal());
  }

  void check(Material& material) {
    if (!(material.medium->mean_free_path.min() > 0))
      throw InputError(file_, "material '" + material.name + "'",
                       "its mean free path is 0 because the model has no size; check its scale");
  }

  Scene& scene_;
  const MediumRules& rules_;
  const std::string& file_;
  BoundingBox box_;
};

void check_names(const Scene& scene, const MediumRules& rules, const std::string& file) {
  std::vector<std::string> names;
  for (const Material& material : scene.materials) names.push_back(material.name);
  const auto require = [&](const std::string& name, const std::string& place) {
    if (name != "*" && std::find(names.begin(), names.end(), name) == names.end())
      throw InputError(file, place, "the model has no material '" + name + "'" + suggestion(name, names));
  };
  for (const auto& [name, rule] : rules.overrides) require(name, "materials");
  for (const std::string& name : rules.subsurface) require(name, "--subsurface");
}

}  // namespace

LengthSpecification parse_length(const std::string& text) {
  LengthSpecification result;
  if (!text.empty() && text.back() == '%') {
    result.relative = true;
    result.value = Rgb(parse_positive(text.substr(0, text.size() - 1), text) / 100);
    return result;
  }
  const std::size_t first = text.find(',');
  if (first == std::string::npos) {
    result.value = Rgb(parse_positive(text, text));
    return result;
  }
  const std::size_t second = text.find(',', first + 1);
  const std::string green = text.substr(first + 1, second == std::string::npos ? second : second - first - 1);
  const std::string blue = second == std::string::npos ? "" : text.substr(second + 1);
  result.value = Rgb(parse_positive(text.substr(0, first), text), parse_positive(green, text),
                     parse_positive(blue, text));
  return result;
}

void apply_medium_rules(Scene& scene, const MediumRules& rules, const std::string& file) {
  check_names(scene, rules, file);
  Rules(scene, rules, file).run();
}

}  // namespace alabaster
