#include "scene/gltf_export.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <map>

#include "core/atomic_file.h"
#include "core/error.h"
#include "image/png_file.h"
#include "image/srgb.h"

namespace alabaster {

namespace {

/// Fills a tinygltf model whose one buffer grows with every view.
class Exporter {
 public:
  Exporter() {
    model_.asset.version = "2.0";
    model_.asset.generator = "alabaster generate";
    model_.buffers.emplace_back();
    model_.scenes.emplace_back();
    model_.defaultScene = 0;
  }

  void add_material(const ExportMaterial& material) {
    tinygltf::Material m;
    m.name = material.name;
    m.pbrMetallicRoughness.baseColorFactor = {material.base_colour.r, material.base_colour.g,
                                              material.base_colour.b, 1};
    m.pbrMetallicRoughness.metallicFactor = material.metallic;
    m.pbrMetallicRoughness.roughnessFactor = material.roughness;
    if (material.texture)
      m.pbrMetallicRoughness.baseColorTexture.index = add_texture(material.texture, material.wrap);
    if (!material.emission.is_black()) set_emission(m, material.emission);
    model_.materials.push_back(std::move(m));
  }

  void add_object(const ExportObject& object) {
    tinygltf::Mesh mesh;
    mesh.name = object.name;
    const auto& materials = object.mesh->materials;
    const uint16_t last =
        materials.empty() ? uint16_t{0} : *std::max_element(materials.begin(), materials.end());
    for (uint16_t material = 0; material <= last; ++material)
      if (std::find(materials.begin(), materials.end(), material) != materials.end())
        mesh.primitives.push_back(make_primitive(*object.mesh, material));
    tinygltf::Node node;
    node.name = object.name;
    node.mesh = static_cast<int>(model_.meshes.size());
    model_.scenes[0].nodes.push_back(static_cast<int>(model_.nodes.size()));
    model_.meshes.push_back(std::move(mesh));
    model_.nodes.push_back(std::move(node));
  }

  const tinygltf::Model& model() const { return model_; }

 private:
  /// Appends bytes as a buffer view, aligned to 4 bytes as accessors demand.
  int add_view(const void* data, std::size_t bytes, int target) {
    auto& buffer = model_.buffers[0].data;
    buffer.resize((buffer.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = buffer.size();
    view.byteLength = bytes;
    view.target = target;
    const auto* first = static_cast<const unsigned char*>(data);
    buffer.insert(buffer.end(), first, first + bytes);
    model_.bufferViews.push_back(view);
    return static_cast<int>(model_.bufferViews.size() - 1);
  }

  template <class Vector>
  int add_vertices(const std::vector<Vector>& values, int type) {
    return add_accessor(values, TINYGLTF_TARGET_ARRAY_BUFFER, TINYGLTF_COMPONENT_TYPE_FLOAT, type);
  }

  template <class Index>
  int add_indices(const std::vector<uint32_t>& indices, int component) {
    return add_accessor(std::vector<Index>(indices.begin(), indices.end()),
                        TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, component, TINYGLTF_TYPE_SCALAR);
  }

  template <class Element>
  int add_accessor(const std::vector<Element>& values, int target, int component, int type) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(values.data(), values.size() * sizeof(Element), target);
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = values.size();
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size() - 1);
  }

  tinygltf::Primitive make_primitive(const TriangleMesh& mesh, uint16_t material) {
    // glTF has one index for all attributes: a vertex is a position with its attributes.
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> vertex_of;
    std::vector<Vec3f> positions, normals;
    std::vector<Vec2f> uvs;
    std::vector<uint32_t> indices;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
      if (mesh.materials[t] != material) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::pair key{mesh.corners[t][k], mesh.attributes[t][k]};
        const auto [entry, fresh] = vertex_of.try_emplace(key, static_cast<uint32_t>(positions.size()));
        indices.push_back(entry->second);
        if (!fresh) continue;
        positions.emplace_back(mesh.positions[key.first]);
        normals.push_back(mesh.normals[key.second]);
        if (!mesh.uv_sets.empty()) uvs.push_back(mesh.uv_sets[0][key.second]);
      }
    }

    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = material;
    primitive.attributes["POSITION"] = add_vertices(positions, TINYGLTF_TYPE_VEC3);
    add_bounds(positions);
    primitive.attributes["NORMAL"] = add_vertices(normals, TINYGLTF_TYPE_VEC3);
    if (!uvs.empty()) primitive.attributes["TEXCOORD_0"] = add_vertices(uvs, TINYGLTF_TYPE_VEC2);
    // 65535 restarts strips: it must not be an index.
    primitive.indices = positions.size() <= 65535
                            ? add_indices<uint16_t>(indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
                            : add_indices<uint32_t>(indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    return primitive;
  }

  /// Bounds of the accessor added last; glTF demands them for positions.
  void add_bounds(const std::vector<Vec3f>& positions) {
    BoundingBox box;
    for (const Vec3f& p : positions) box.extend(Vec3(p));
    tinygltf::Accessor& accessor = model_.accessors.back();
    accessor.minValues = {box.low.x, box.low.y, box.low.z};
    accessor.maxValues = {box.high.x, box.high.y, box.high.z};
  }

  int add_texture(const std::shared_ptr<const TexelArray>& texels, Wrap wrap) {
    const auto [entry, fresh] = image_of_.try_emplace(texels.get(), static_cast<int>(model_.images.size()));
    if (fresh) {
      const std::vector<uint8_t> png = encode_srgb_png(*texels);
      tinygltf::Image image;
      image.mimeType = "image/png";
      image.bufferView = add_view(png.data(), png.size(), 0);
      model_.images.push_back(std::move(image));
    }
    tinygltf::Sampler sampler;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    sampler.wrapS = sampler.wrapT = wrap == Wrap::repeat   ? TINYGLTF_TEXTURE_WRAP_REPEAT
                                    : wrap == Wrap::mirror ? TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT
                                                           : TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    tinygltf::Texture texture;
    texture.source = entry->second;
    texture.sampler = static_cast<int>(model_.samplers.size());
    model_.samplers.push_back(sampler);
    model_.textures.push_back(texture);
    return static_cast<int>(model_.textures.size() - 1);
  }

  void set_emission(tinygltf::Material& material, const Rgb& emission) {
    const double strength = std::max(1.0, emission.max());
    const Rgb factor = emission / strength;
    material.emissiveFactor = {factor.r, factor.g, factor.b};
    if (strength == 1) return;
    const std::string extension = "KHR_materials_emissive_strength";
    material.extensions[extension] =
        tinygltf::Value(tinygltf::Value::Object{{"emissiveStrength", tinygltf::Value(strength)}});
    auto& used = model_.extensionsUsed;
    if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
  }

  tinygltf::Model model_;
  std::map<const TexelArray*, int> image_of_;
};

}  // namespace

std::vector<uint8_t> encode_srgb_png(const TexelArray& texels) {
  Pixels8 pixels(texels.width, texels.height, 3);
  for (int y = 0; y < texels.height; ++y)
    for (int x = 0; x < texels.width; ++x)
      for (int c = 0; c < 3; ++c)
        pixels.at(x, y)[c] = linear_to_srgb8(static_cast<double>(texels.at(x, y)[c]));
  return encode_png(pixels);
}

void write_glb(const std::filesystem::path& path, const ExportScene& scene) {
  Exporter exporter;
  for (const ExportMaterial& material : scene.materials) exporter.add_material(material);
  for (const ExportObject& object : scene.objects) exporter.add_object(object);
  write_file_atomically(path, [&](const std::filesystem::path& temporary) {
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToFile(&exporter.model(), temporary.string(), true, true, false, true))
      throw InputError(path.string(), "cannot be written; check the folder and the free space");
  });
}

}  // namespace alabaster
