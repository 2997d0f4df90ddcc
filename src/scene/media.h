#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// A length as the command line gives it: metres, one per channel, or per cent of the scene's box diagonal.
struct LengthSpecification {
  Rgb value;  // m, or fraction of the diagonal
  bool relative = false;
};
/// Parses "0.01", "0.01,0.005,0.002" or "0.5%"; throws InputError.
LengthSpecification parse_length(const std::string& text);

/// What a scene file says of one material; absent members leave what stands.
struct MaterialOverride {
  using Colour = std::variant<Rgb, std::filesystem::path>;  // or a picture in UV set 0

  std::optional<bool> subsurface;
  std::optional<Colour> albedo;       // single scattering
  std::optional<Colour> reflectance;  // multiple scattering, inverted
  std::optional<LengthSpecification> mean_free_path;
  std::optional<double> density;                     // divides the mean free path
  std::optional<std::filesystem::path> density_map;  // a picture: share of sigma_t from place to place
  std::optional<double> g, eta, roughness;
};

/// Everything that decides which materials have a medium, in rising precedence: the model's extensions and
/// the default rule, the override "*", the override of the material's name, then the members below.
struct MediumRules {
  std::map<std::string, MaterialOverride> overrides;  // by material name, or "*"
  std::vector<std::string> subsurface;  // when not empty, the default rule is off and these get a medium
  std::optional<LengthSpecification> mean_free_path;
  std::optional<double> g, eta;
  std::string subsurface_map;  // path of a picture, R channel, for every medium
  /// Without this, only materials with an override or from the list above become media by rule.
  bool default_rule = true;
};

/// Gives materials their media. Needs scene.objects and scene.materials; lengths in per cent refer to the
/// diagonal of the box around all objects. Throws InputError (naming `file`) for materials that do not exist.
void apply_medium_rules(Scene& scene, const MediumRules& rules, const std::string& file);

}  // namespace alabaster
