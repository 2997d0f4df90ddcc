#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "scene/gltf_document.h"
#include "texture/texel_array.h"
#include "texture/texture.h"

namespace tinygltf {
class Value;
struct TextureInfo;
}  // namespace tinygltf

namespace alabaster {

/// How a material refers to a texture: index, UV set and KHR_texture_transform.
struct TextureReference {
  int index = -1;
  std::size_t uv_set = 0;
  Vec2 offset{0}, scale{1};
  double rotation = 0;

  explicit operator bool() const { return index >= 0; }
};

TextureReference texture_reference(const tinygltf::Value& info);

/// Decodes each picture of a file at most once per encoding.
class GltfTextures {
 public:
  explicit GltfTextures(const GltfDocument& document) : document_(document) {}

  /// Null when the reference is empty. `primary_uv_set` is swapped with set 0.
  std::shared_ptr<const Texture> load(const TextureReference& reference, Encoding encoding,
                                      std::size_t primary_uv_set);

 private:
  std::shared_ptr<const TexelArray> texels(int image, Encoding encoding);

  const GltfDocument& document_;
  std::map<std::pair<int, Encoding>, std::shared_ptr<const TexelArray>> pictures_;
};

}  // namespace alabaster
