#include "scene/gltf_export.h"

#include <tiny_gltf.h>

#include <catch2/catch.hpp>
#include <cstring>

#include "core/atomic_file.h"
#include "core/error.h"
#include "geometry/shapes.h"
#include "scene/scene_file.h"
#include "support/paths.h"
#include "texture/patterns.h"

using namespace alabaster;

namespace {

/// Reads with the library's own loader, independent of the program's importer.
tinygltf::Model read_back(const std::filesystem::path& path) {
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string errors, warnings;
  REQUIRE(loader.LoadBinaryFromFile(&model, &errors, &warnings, path.string()));
  CHECK(errors.empty());
  CHECK(warnings.empty());
  return model;
}

template <class T>
std::vector<T> accessor_values(const tinygltf::Model& model, int index) {
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
  const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  CHECK(view.byteOffset % 4 == 0);
  std::vector<T> values(accessor.count);
  REQUIRE(view.byteLength == values.size() * sizeof(T));
  std::memcpy(values.data(), model.buffers[0].data.data() + view.byteOffset, view.byteLength);
  return values;
}

ExportScene two_material_scene(const TriangleMesh& cylinder, const TriangleMesh& plane) {
  ExportScene scene;
  const auto pattern = std::make_shared<TexelArray>(make_pattern("checker", 20));
  scene.materials = {{"side", Rgb(0.5, 0.25, 1), pattern, Wrap::repeat, 0, 0.3, Rgb(0)},
                     {"caps", Rgb(1), pattern, Wrap::clamp, 1, 0.7, Rgb(0)},
                     {"lamp", Rgb(0), nullptr, Wrap::repeat, 0, 1, Rgb(4, 2, 1)}};
  scene.objects = {{"drum", &cylinder}, {"panel", &plane}};
  return scene;
}

}  // namespace

TEST_CASE("an exported scene reads back with the same triangles, normals and UVs") {
  TriangleMesh cylinder = make_cylinder(0.5, 2, 24), plane = make_plane(1);
  for (uint32_t t = 0; t < cylinder.triangle_count(); ++t)
    cylinder.materials[t] = std::abs(cylinder.geometric_normal(t).y) > 0.5 ? 1 : 0;
  for (auto& material : plane.materials) material = 2;
  const ScratchFolder folder;
  write_glb(folder / "scene.glb", two_material_scene(cylinder, plane));

  const tinygltf::Model model = read_back(folder / "scene.glb");
  REQUIRE(model.meshes.size() == 2);
  REQUIRE(model.meshes[0].primitives.size() == 2);
  CHECK(model.nodes[0].name == "drum");
  std::size_t triangles = 0;
  for (const tinygltf::Primitive& primitive : model.meshes[0].primitives) {
    const auto positions = accessor_values<Vec3f>(model, primitive.attributes.at("POSITION"));
    const auto normals = accessor_values<Vec3f>(model, primitive.attributes.at("NORMAL"));
    const auto uvs = accessor_values<Vec2f>(model, primitive.attributes.at("TEXCOORD_0"));
    const auto indices = accessor_values<uint16_t>(model, primitive.indices);
    std::size_t k = 0;
    for (uint32_t t = 0; t < cylinder.triangle_count(); ++t) {
      if (cylinder.materials[t] != primitive.material) continue;
      for (std::size_t c = 0; c < 3; ++c, ++k) {
        REQUIRE(positions[indices[k]] == Vec3f(cylinder.positions[cylinder.corners[t][c]]));
        REQUIRE(normals[indices[k]] == cylinder.normals[cylinder.attributes[t][c]]);
        REQUIRE(uvs[indices[k]] == cylinder.uv_sets[0][cylinder.attributes[t][c]]);
      }
      ++triangles;
    }
    REQUIRE(k == indices.size());
  }
  CHECK(triangles == cylinder.triangle_count());
}

TEST_CASE("materials, textures and samplers are written as glTF means them") {
  const TriangleMesh cylinder = make_cylinder(0.5, 2, 24), plane = make_plane(1);
  const ScratchFolder folder;
  write_glb(folder / "scene.glb", two_material_scene(cylinder, plane));
  const tinygltf::Model model = read_back(folder / "scene.glb");

  REQUIRE(model.materials.size() == 3);
  CHECK(model.materials[0].pbrMetallicRoughness.baseColorFactor == std::vector<double>{0.5, 0.25, 1, 1});
  CHECK(model.materials[0].pbrMetallicRoughness.roughnessFactor == 0.3);
  CHECK(model.materials[1].pbrMetallicRoughness.metallicFactor == 1);
  CHECK(model.materials[2].pbrMetallicRoughness.baseColorTexture.index == -1);
  CHECK(model.materials[2].emissiveFactor == std::vector<double>{1, 0.5, 0.25});
  const auto& strength = model.materials[2].extensions.at("KHR_materials_emissive_strength");
  CHECK(strength.Get("emissiveStrength").GetNumberAsDouble() == 4);

  REQUIRE(model.images.size() == 1);  // shared by two materials
  REQUIRE(model.textures.size() == 2);
  CHECK(model.samplers[0].wrapS == TINYGLTF_TEXTURE_WRAP_REPEAT);
  CHECK(model.samplers[1].wrapS == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE);
  // sRGB codes of 0.95 and 0.5.
  const tinygltf::Image& image = model.images[0];
  REQUIRE(image.width == 20);
  CHECK(int{image.image[0]} == 249);
  CHECK(int{image.image[static_cast<std::size_t>(2 * image.component)]} == 188);
}

TEST_CASE("the same scene gives the same bytes, and indices widen beyond 65535 vertices") {
  const TriangleMesh plane = make_plane(1, 300);  // 90601 vertices
  ExportScene scene;
  scene.objects = {{"plane", &plane}};
  scene.materials = {{"grey", Rgb(0.5), nullptr, Wrap::repeat, 0, 0.5, Rgb(0)}};
  const ScratchFolder folder;
  write_glb(folder / "a.glb", scene);
  write_glb(folder / "b.glb", scene);
  CHECK(read_text(folder / "a.glb") == read_text(folder / "b.glb"));
  const tinygltf::Model model = read_back(folder / "a.glb");
  const auto indices = accessor_values<uint32_t>(model, model.meshes[0].primitives[0].indices);
  CHECK(indices.size() == 3 * plane.triangle_count());
}

TEST_CASE("a file that cannot be written is the user's error, in one line") {
  const TriangleMesh plane = make_plane(1);
  ExportScene scene;
  scene.objects = {{"plane", &plane}};
  scene.materials.emplace_back();
  CHECK_THROWS_AS(write_glb("/proc/nowhere/a.glb", scene), InputError);
}

TEST_CASE("an exported model comes back through the importer: welded, closed, with its texture") {
  const TriangleMesh blob = make_blob(0.05, 0.2, 48);
  const auto pattern = std::make_shared<TexelArray>(make_pattern("dots", 40));
  ExportScene exported;
  exported.objects = {{"blob", &blob}};
  exported.materials = {{"stone", Rgb(1), pattern, Wrap::repeat, 0, 0.4, Rgb(0)}};
  const ScratchFolder folder;
  write_glb(folder / "blob.glb", exported);

  const LoadedScene loaded = load_scene(folder / "blob.glb", {});
  REQUIRE(loaded.scene.objects.size() == 1);
  const SceneObject& object = loaded.scene.objects[0];
  CHECK(object.name == "blob");
  CHECK(object.mesh.triangle_count() == blob.triangle_count());
  CHECK(object.mesh.positions.size() == blob.positions.size());
  CHECK(object.report.closed);
  CHECK(object.report.degenerate_triangles + object.report.duplicate_triangles == 0);
  CHECK(object.atlas.chart_count() == 6);
  CHECK(enclosed_volume(object.mesh) == Approx(enclosed_volume(blob)).epsilon(1e-5));
  REQUIRE(loaded.scene.materials.size() == 1);
  const Material& material = loaded.scene.materials[0];
  CHECK(material.medium.has_value());
  CHECK(material.roughness_factor == Approx(0.4));
  REQUIRE(material.base_colour);
  const TexelArray& texels = material.base_colour->texels();
  REQUIRE(texels.width == 40);
  // One 8-bit code apart at most: half a code's width at 0.95.
  for (int x = 0; x < 40; ++x) CHECK(texels.at(x, x).r == Approx(pattern->at(x, x).r).margin(0.005));
}
