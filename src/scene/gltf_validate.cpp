#include "scene/gltf_validate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/error.h"

namespace alabaster {

namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 13> supported_extensions{"EXT_texture_webp",
                                                                "KHR_lights_punctual",
                                                                "KHR_materials_diffuse_transmission",
                                                                "KHR_materials_emissive_strength",
                                                                "KHR_materials_ior",
                                                                "KHR_materials_scatter",
                                                                "KHR_materials_transmission",
                                                                "KHR_materials_unlit",
                                                                "KHR_materials_volume",
                                                                "KHR_materials_volume_scatter",
                                                                "KHR_mesh_quantization",
                                                                "KHR_texture_transform",
                                                                "KHR_materials_variants"};

/// What to do about the extensions that are met most.
std::string mend_for(std::string_view extension) {
  if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression")
    return "export it without mesh compression";
  if (extension == "KHR_texture_basisu") return "export it with PNG, JPEG or WebP textures";
  return "export it without this extension";
}

class Validator {
 public:
  Validator(const std::string& file, const json& root) : file_(file), root_(root) {}

  void run(std::vector<std::string>& remarks) {
    if (!root_.is_object()) throw InputError(file_, "its root is not a JSON object; this is not glTF");
    check_version();
    check_extensions(remarks);
    check_buffers();
    check_meshes();
    check_nodes();
    check_textures();
    check_cameras();
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& problem) const {
    throw InputError(file_, place, problem);
  }

  /// A top-level array; empty when absent.
  const json& array(const char* name) const {
    static const json none = json::array();
    const auto it = root_.find(name);
    if (it == root_.end()) return none;
    if (!it->is_array()) fail(name, "must be an array; export the file again");
    return *it;
  }

  template <typename Body>
  void for_each(const char* name, const Body& body) const {
    const json& elements = array(name);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const std::string place = fmt::format("{}[{}]", name, i);
      if (!elements[i].is_object()) fail(place, "must be an object; export the file again");
      body(elements[i], place);
    }
  }

  /// `key` of `object`, if present, must be an index into the array `target` of `size` elements.
  void check_index(const json& object, const char* key, std::size_t size, const char* target,
                   const std::string& place) const {
    const auto it = object.find(key);
    if (it != object.end()) check_index_value(*it, size, target, place + "." + key);
  }
  void check_index(const json& object, const char* key, const char* target, const std::string& place) const {
    check_index(object, key, array(target).size(), target, place);
  }
  void check_index_value(const json& value, std::size_t size, const char* target,
                         const std::string& place) const {
    if (!value.is_number_integer() || value.get<int64_t>() < 0 ||
        static_cast<std::size_t>(value.get<int64_t>()) >= size)
      fail(place,
           fmt::format("is {}, but there are {} {}; export the file again", value.dump(), size, target));
  }

  std::size_t whole_number(const json& object, const char* key, std::size_t fallback,
                           const std::string& place) const {
    const auto it = object.find(key);
    if (it == object.end()) return fallback;
    if (!it->is_number_integer() || it->get<int64_t>() < 0)
      fail(place + "." + key, "is " + it->dump() + "; it must be a whole number; export the file again");
    return static_cast<std::size_t>(it->get<int64_t>());
  }

  const json& child(const json& object, const char* key, const std::string& place) const {
    static const json none = json::object();
    const auto it = object.find(key);
    if (it == object.end()) return none;
    if (!it->is_object()) fail(place + "." + key, "must be an object; export the file again");
    return *it;
  }

  void check_version() const {
    const json& asset = child(root_, "asset", "root");
    const auto it = asset.find("version");
    if (it == asset.end() || !it->is_string())
      fail("asset.version", "is missing; this is not glTF 2.0, export it as such");
    const auto version = it->get<std::string>();
    if (version.substr(0, 2) != "2.")
      fail("asset.version", "is '" + version + "'; only 2.0 can be read, export it as glTF 2.0");
  }

  static bool supported(const std::string& name) {
    return std::find(supported_extensions.begin(), supported_extensions.end(), name) !=
           supported_extensions.end();
  }

  void check_extensions(std::vector<std::string>& remarks) const {
    for (const json& name : array("extensionsRequired")) {
      if (!name.is_string()) fail("extensionsRequired", "must hold names; export the file again");
      if (const auto text = name.get<std::string>(); !supported(text))
        fail("extensionsRequired", "needs " + text + ", which is not supported; " + mend_for(text));
    }
    std::vector<std::string> ignored;
    for (const json& name : array("extensionsUsed"))
      if (name.is_string() && !supported(name.get<std::string>())) ignored.push_back(name);
    if (!ignored.empty())
      remarks.push_back(
          fmt::format("extensions that are not supported are ignored: {}", fmt::join(ignored, ", ")));
  }

  void check_buffers() const {
    for_each("buffers", [&](const json& buffer, const std::string& place) {
      whole_number(buffer, "byteLength", 0, place);
    });
    for_each("bufferViews", [&](const json& view, const std::string& place) {
      if (!view.contains("buffer")) fail(place + ".buffer", "is missing; export the file again");
      check_index(view, "buffer", "buffers", place);
      const json& buffer = array("buffers")[view["buffer"].get<std::size_t>()];
      const std::size_t size = whole_number(buffer, "byteLength", 0, "buffers");
      const std::size_t offset = whole_number(view, "byteOffset", 0, place);
      const std::size_t length = whole_number(view, "byteLength", 0, place);
      if (offset > size || length > size - offset)
        fail(place,
             fmt::format("ends at byte {}, but its buffer has {}; the file is damaged, export it again",
                         offset + length, size));
    });
    for_each("accessors", [&](const json& accessor, const std::string& place) {
      check_index(accessor, "bufferView", "bufferViews", place);
      whole_number(accessor, "byteOffset", 0, place);
      whole_number(accessor, "count", 0, place);
      const json& sparse = child(accessor, "sparse", place);
      for (const char* part : {"indices", "values"})
        check_index(child(sparse, part, place + ".sparse"), "bufferView", "bufferViews",
                    place + ".sparse." + part);
    });
    for_each("images", [&](const json& image, const std::string& place) {
      check_index(image, "bufferView", "bufferViews", place);
    });
  }

  void check_meshes() const {
    for_each("meshes", [&](const json& mesh, const std::string& mesh_place) {
      const auto it = mesh.find("primitives");
      if (it == mesh.end() || !it->is_array())
        fail(mesh_place + ".primitives", "is missing; export the file again");
      for (std::size_t i = 0; i < it->size(); ++i) {
        const json& primitive = (*it)[i];
        const std::string place = fmt::format("{}.primitives[{}]", mesh_place, i);
        if (!primitive.is_object()) fail(place, "must be an object; export the file again");
        check_index(primitive, "indices", "accessors", place);
        check_index(primitive, "material", "materials", place);
        check_attributes(child(primitive, "attributes", place), place + ".attributes");
        const auto targets = primitive.find("targets");
        if (targets == primitive.end()) continue;
        if (!targets->is_array()) fail(place + ".targets", "must be an array; export the file again");
        for (const json& target : *targets) check_attributes(target, place + ".targets");
      }
    });
  }

  void check_attributes(const json& attributes, const std::string& place) const {
    if (!attributes.is_object()) fail(place, "must be an object; export the file again");
    for (const auto& [name, accessor] : attributes.items())
      check_index_value(accessor, array("accessors").size(), "accessors", place + "." + name);
  }

  void check_nodes() const {
    const json& nodes = array("nodes");
    const json& extensions = child(root_, "extensions", "root");
    const json& punctual = child(extensions, "KHR_lights_punctual", "extensions");
    const std::size_t lights = punctual.contains("lights") ? punctual["lights"].size() : 0;
    std::vector<bool> has_parent(nodes.size(), false);
    for_each("nodes", [&](const json& node, const std::string& place) {
      check_index(node, "mesh", "meshes", place);
      check_index(node, "camera", "cameras", place);
      check_index(node, "skin", "skins", place);
      const json& light =
          child(child(node, "extensions", place), "KHR_lights_punctual", place + ".extensions");
      check_index(light, "light", lights, "lights", place + ".extensions.KHR_lights_punctual");
      for_each_index(node, "children", "nodes", place, [&](std::size_t index) {
        if (has_parent[index])
          fail(fmt::format("nodes[{}]", index),
               "has two parents; a node may have one, export the file again");
        has_parent[index] = true;
      });
    });
    // With one parent each, a node that cannot be reached from a root lies on a ring.
    check_reachable(nodes, has_parent);
    for_each("scenes", [&](const json& scene, const std::string& place) {
      for_each_index(scene, "nodes", "nodes", place, [](std::size_t) {});
    });
    check_index(root_, "scene", "scenes", "root");
    for_each("skins", [&](const json& skin, const std::string& place) {
      check_index(skin, "inverseBindMatrices", "accessors", place);
      for_each_index(skin, "joints", "nodes", place, [](std::size_t) {});
    });
  }

  template <typename Body>
  void for_each_index(const json& object, const char* key, const char* target, const std::string& place,
                      const Body& body) const {
    const auto it = object.find(key);
    if (it == object.end()) return;
    if (!it->is_array()) fail(place + "." + key, "must be an array; export the file again");
    for (const json& index : *it) {
      check_index_value(index, array(target).size(), target, place + "." + key);
      body(index.get<std::size_t>());
    }
  }

  void check_reachable(const json& nodes, const std::vector<bool>& has_parent) const {
    std::vector<bool> seen(nodes.size(), false);
    std::vector<std::size_t> stack;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (!has_parent[i]) stack.push_back(i);
    while (!stack.empty()) {
      const std::size_t index = stack.back();
      stack.pop_back();
      seen[index] = true;
      const auto it = nodes[index].find("children");
      if (it == nodes[index].end()) continue;
      for (const json& next : *it) stack.push_back(next.get<std::size_t>());
    }
    const auto lost = std::find(seen.begin(), seen.end(), false);
    if (lost != seen.end())
      fail(fmt::format("nodes[{}]", lost - seen.begin()),
           "is its own ancestor; break the ring and export again");
  }

  void check_textures() const {
    for_each("textures", [&](const json& texture, const std::string& place) {
      check_index(texture, "source", "images", place);
      check_index(texture, "sampler", "samplers", place);
      const json& webp =
          child(child(texture, "extensions", place), "EXT_texture_webp", place + ".extensions");
      check_index(webp, "source", "images", place + ".extensions.EXT_texture_webp");
    });
    for_each("materials",
             [&](const json& material, const std::string& place) { check_texture_infos(material, place); });
  }

  /// Every member whose name ends in "Texture", at any depth, refers to a texture.
  void check_texture_infos(const json& object, const std::string& place) const {
    for (const auto& [key, value] : object.items()) {
      if (!value.is_object() || key == "extras") continue;
      constexpr std::string_view ending = "Texture";
      if (key.size() >= ending.size() && key.ends_with(ending)) {
        if (!value.contains("index")) fail(place + "." + key + ".index", "is missing; export the file again");
        check_index(value, "index", "textures", place + "." + key);
        whole_number(value, "texCoord", 0, place + "." + key);
      }
      check_texture_infos(value, place + "." + key);
    }
  }

  void check_cameras() const {
    for_each("cameras", [&](const json& camera, const std::string& place) {
      const std::string type = camera.value("type", std::string());
      if (type != "perspective" && type != "orthographic")
        fail(place + ".type", "must be perspective or orthographic; export the file again");
    });
  }

  const std::string& file_;
  const json& root_;
};

}  // namespace

void validate_gltf(const std::string& file, const json& root, std::vector<std::string>& remarks) {
  try {
    Validator(file, root).run(remarks);
  } catch (const json::exception& error) {
    throw InputError(file, std::string("has a value of the wrong type: ") + error.what());
  }
}

}  // namespace alabaster
