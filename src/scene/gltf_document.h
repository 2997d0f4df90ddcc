#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace alabaster {

/// A parsed glTF file whose every index is known to be in range. Images hold their encoded bytes.
struct GltfDocument {
  std::string file;
  std::unique_ptr<tinygltf::Model> model;
  std::vector<std::string> remarks;  // what the file asks for and does not get

  GltfDocument();
  ~GltfDocument();
  GltfDocument(GltfDocument&&) noexcept;
};

/// Reads .gltf (with files beside it or data URIs) or .glb. Throws InputError with file, place and mend for
/// anything that is cut short, malformed, out of range, or needs an extension that is not supported.
GltfDocument read_gltf(const std::filesystem::path& path);

/// "meshes[3] 'name'" for messages.
std::string gltf_place(const char* kind, std::size_t index, const std::string& name);

}  // namespace alabaster
