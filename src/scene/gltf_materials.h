#pragma once

#include <string>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace alabaster {

/// A file's materials, with the media that extensions ask for. One more material, glTF's default, stands at
/// the end.
struct GltfMaterials {
  std::vector<Material> materials;
  /// Per material: the UV set of its albedo. The importer swaps that set with set 0 in the primitives that
  /// use the material, and the textures here count on it: albedo always lies in set 0.
  std::vector<std::size_t> primary_uv_set;
  std::vector<std::string> warnings;
};

/// Reads materials and decodes the textures they use. Throws InputError for pictures that are missing or
/// damaged.
GltfMaterials read_materials(const GltfDocument& document);

}  // namespace alabaster
