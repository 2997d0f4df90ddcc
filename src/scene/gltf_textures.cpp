#include "scene/gltf_textures.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "core/error.h"
#include "image/image_decode.h"

namespace alabaster {

namespace {

Vec2 pair_of(const tinygltf::Value& value, Vec2 fallback) {
  if (!value.IsArray() || value.ArrayLen() != 2) return fallback;
  return {value.Get(0).GetNumberAsDouble(), value.Get(1).GetNumberAsDouble()};
}

Wrap wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp;
  if (mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::mirror;
  return Wrap::repeat;
}

/// The image of a texture: WebP when offered, else the ordinary source.
int image_of(const tinygltf::Texture& texture) {
  const auto webp = texture.extensions.find("EXT_texture_webp");
  if (webp != texture.extensions.end() && webp->second.Has("source"))
    return webp->second.Get("source").GetNumberAsInt();
  return texture.source;
}

}  // namespace

TextureReference texture_reference(const tinygltf::Value& info) {
  TextureReference reference;
  if (!info.IsObject() || !info.Has("index")) return reference;
  reference.index = info.Get("index").GetNumberAsInt();
  if (info.Has("texCoord"))
    reference.uv_set = static_cast<std::size_t>(info.Get("texCoord").GetNumberAsInt());
  if (!info.Has("extensions")) return reference;
  const tinygltf::Value& transform = info.Get("extensions").Get("KHR_texture_transform");
  if (!transform.IsObject()) return reference;
  reference.offset = pair_of(transform.Get("offset"), reference.offset);
  reference.scale = pair_of(transform.Get("scale"), reference.scale);
  if (transform.Has("rotation")) reference.rotation = transform.Get("rotation").GetNumberAsDouble();
  if (transform.Has("texCoord"))
    reference.uv_set = static_cast<std::size_t>(transform.Get("texCoord").GetNumberAsInt());
  return reference;
}

std::shared_ptr<const Texture> GltfTextures::load(const TextureReference& reference, Encoding encoding,
                                                  std::size_t primary_uv_set) {
  if (!reference) return nullptr;
  const tinygltf::Model& model = *document_.model;
  const tinygltf::Texture& texture = model.textures[static_cast<std::size_t>(reference.index)];
  const int image = image_of(texture);
  if (image < 0)
    throw InputError(document_.file,
                     gltf_place("textures", static_cast<std::size_t>(reference.index), texture.name),
                     "has no image in a format that can be read; export it with PNG, JPEG or WebP textures");
  TextureMapping mapping;
  if (texture.sampler >= 0) {
    const tinygltf::Sampler& sampler = model.samplers[static_cast<std::size_t>(texture.sampler)];
    mapping.wrap_u = wrap_of(sampler.wrapS);
    mapping.wrap_v = wrap_of(sampler.wrapT);
    if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) mapping.filter = Filter::nearest;
  }
  mapping.uv_set = reference.uv_set == primary_uv_set ? 0
                   : reference.uv_set == 0            ? primary_uv_set
                                                      : reference.uv_set;
  mapping.offset = reference.offset;
  mapping.scale = reference.scale;
  mapping.rotation = reference.rotation;
  return std::make_shared<Texture>(texels(image, encoding), mapping);
}

std::shared_ptr<const TexelArray> GltfTextures::texels(int index, Encoding encoding) {
  auto& cached = pictures_[{index, encoding}];
  if (cached) return cached;
  const tinygltf::Image& image = document_.model->images[static_cast<std::size_t>(index)];
  const bool external = !image.uri.empty();
  const std::string name =
      gltf_place("images", static_cast<std::size_t>(index), external ? image.uri : image.name);
  if (image.image.empty())
    throw InputError(
        document_.file, name,
        external ? "cannot be read; put the picture beside the model" : "is empty; export it again");
  cached = std::make_shared<TexelArray>(
      make_texels(decode_image(image.image, document_.file + ": " + name), encoding));
  return cached;
}

}  // namespace alabaster
