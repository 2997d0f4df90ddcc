#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/rgb.h"
#include "geometry/mesh.h"
#include "texture/texture.h"

namespace alabaster {

/// A plain glTF metallic-roughness material. Colours are linear; the texture is written as an 8-bit sRGB PNG.
/// Materials that share a texture share its image.
struct ExportMaterial {
  std::string name;
  Rgb base_colour{1};
  std::shared_ptr<const TexelArray> texture;  // times base_colour; may be empty
  Wrap wrap = Wrap::repeat;
  double metallic = 0, roughness = 0.5;
  Rgb emission{0};  // W/(sr m^2); above 1 through KHR_materials_emissive_strength
};

/// One node with one mesh; mesh->materials index the materials of the scene.
struct ExportObject {
  std::string name;
  const TriangleMesh* mesh = nullptr;
};

struct ExportScene {
  std::vector<ExportObject> objects;
  std::vector<ExportMaterial> materials;
};

/// Writes a self-contained binary glTF 2.0 file: one primitive per material of a mesh, positions and normals
/// in float, UV set 0 if there is one. The file appears whole or not at all; the same scene gives the same
/// bytes. Throws InputError when it cannot be written.
void write_glb(const std::filesystem::path& path, const ExportScene& scene);

/// The texels' RGB as an sRGB PNG file in memory, clamped to [0, 1].
std::vector<uint8_t> encode_srgb_png(const TexelArray& texels);

}  // namespace alabaster
