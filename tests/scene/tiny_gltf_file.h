#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/paths.h"

/// A glTF file in the making: one buffer as a data URI, accessors one by one. Tests bend `root` as they like.
struct TinyGltfFile {
  using json = nlohmann::json;

  static constexpr int u8 = 5121, u16 = 5123, u32 = 5125, f32 = 5126, i8 = 5120, i16 = 5122;

  json root;
  std::vector<uint8_t> bytes;

  TinyGltfFile() {
    root = {{"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", json::array({0})}}}},
            {"nodes", json::array()},
            {"meshes", json::array()},
            {"accessors", json::array()},
            {"bufferViews", json::array()}};
  }

  template <typename T>
  int add_view(const std::vector<T>& values, int stride = 0) {
    while (bytes.size() % 4 != 0) bytes.push_back(0);
    json view{{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride > 0) view["byteStride"] = stride;
    const std::size_t offset = bytes.size();
    bytes.resize(offset + values.size() * sizeof(T));
    std::memcpy(bytes.data() + offset, values.data(), values.size() * sizeof(T));
    root["bufferViews"].push_back(view);
    return static_cast<int>(root["bufferViews"].size()) - 1;
  }

  template <typename T>
  int add_accessor(const std::vector<T>& values, const std::string& type, bool normalized = false) {
    const int view = add_view(values);
    root["accessors"].push_back({{"bufferView", view},
                                 {"componentType", component<T>()},
                                 {"count", values.size() / components(type)},
                                 {"type", type},
                                 {"normalized", normalized}});
    return static_cast<int>(root["accessors"].size()) - 1;
  }

  /// A mesh with one primitive, and a node that shows it; returns the primitive.
  json& add_mesh(const json& attributes, int indices = -1) {
    json primitive{{"attributes", attributes}};
    if (indices >= 0) primitive["indices"] = indices;
    root["meshes"].push_back({{"primitives", json::array({primitive})}});
    root["nodes"].push_back({{"mesh", root["meshes"].size() - 1}});
    root["scenes"][0]["nodes"] = json::array();
    for (std::size_t i = 0; i < root["nodes"].size(); ++i) root["scenes"][0]["nodes"].push_back(i);
    return root["meshes"].back()["primitives"][0];
  }

  /// Unit square in z = 0 seen from +z, two triangles, four vertices, with UVs that run downwards.
  json& add_square() {
    const int positions = add_accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
    const int uvs = add_accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2");
    const int indices = add_accessor<uint16_t>({0, 1, 2, 0, 2, 3}, "SCALAR");
    return add_mesh({{"POSITION", positions}, {"TEXCOORD_0", uvs}}, indices);
  }

  /// Adds a picture as an image, a texture and returns the texture's index.
  int add_texture(const std::vector<uint8_t>& picture, const std::string& mime = "image/png") {
    const int view = add_view(picture);
    root["images"].push_back({{"bufferView", view}, {"mimeType", mime}});
    root["textures"].push_back({{"source", root["images"].size() - 1}});
    return static_cast<int>(root["textures"].size()) - 1;
  }

  std::filesystem::path write(const ScratchFolder& folder, const char* name = "model.gltf") {
    if (!bytes.empty())
      root["buffers"] = json::array(
          {{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}});
    const std::filesystem::path path = folder / name;
    std::ofstream(path) << root.dump(1);
    return path;
  }

  /// The same as a binary file; `cut` bytes are missing at the end.
  std::filesystem::path write_glb(const ScratchFolder& folder, std::size_t cut = 0) {
    while (bytes.size() % 4 != 0) bytes.push_back(0);
    root["buffers"] = json::array({{{"byteLength", bytes.size()}}});
    std::string text = root.dump();
    while (text.size() % 4 != 0) text += ' ';
    std::string out = "glTF";
    const auto put = [&](std::size_t v) {
      for (int i = 0; i < 4; ++i) out += static_cast<char>((v >> (8 * i)) & 255);
    };
    put(2);
    put(12 + 8 + text.size() + 8 + bytes.size());
    put(text.size());
    out += "JSON" + text;
    put(bytes.size());
    out += std::string("BIN\0", 4);
    out.append(bytes.begin(), bytes.end());
    const std::filesystem::path path = folder / "model.glb";
    std::ofstream(path, std::ios::binary).write(out.data(), static_cast<std::streamsize>(out.size() - cut));
    return path;
  }

  static std::string base64(const std::vector<uint8_t>& in) {
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < in.size(); i += 3) {
      uint32_t word = 0;
      for (std::size_t k = 0; k < 3; ++k) word = (word << 8) | (i + k < in.size() ? in[i + k] : 0u);
      for (std::size_t k = 0; k < 4; ++k)
        out += k <= in.size() - i ? digits[(word >> (18 - 6 * k)) & 63] : '=';
    }
    return out;
  }

 private:
  template <typename T>
  static int component() {
    if (std::is_same_v<T, uint8_t>) return u8;
    if (std::is_same_v<T, int8_t>) return i8;
    if (std::is_same_v<T, uint16_t>) return u16;
    if (std::is_same_v<T, int16_t>) return i16;
    if (std::is_same_v<T, uint32_t>) return u32;
    return f32;
  }
  static std::size_t components(const std::string& type) {
    return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "MAT4" ? 16 : 4;
  }
};
