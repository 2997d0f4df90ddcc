#include "scene/gltf_import.h"

#include <webp/encode.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "image/png_file.h"
#include "scene/tiny_gltf_file.h"
#include "support/paths.h"

using namespace alabaster;
using json = nlohmann::json;

namespace {

double total_area(const GltfScene& scene) {
  double area = 0;
  for (const SceneObject& object : scene.objects) area += surface_area(object.mesh);
  return area;
}

bool warned(const std::vector<std::string>& warnings, const std::string& part) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

std::vector<uint8_t> png_of(const std::vector<std::array<uint8_t, 4>>& pixels, int width) {
  Pixels8 image(width, static_cast<int>(pixels.size()) / width, 4);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    for (std::size_t c = 0; c < 4; ++c) image.bytes.at(4 * i + c) = pixels[i][c];
  return encode_png(image);
}

}  // namespace

TEST_CASE("a square loads from data URIs and from binary glTF alike") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square();
  for (const auto& path : {file.write(folder), file.write_glb(folder)}) {
    const GltfScene scene = import_gltf(path);
    REQUIRE(scene.objects.size() == 1);
    const TriangleMesh& mesh = scene.objects[0].mesh;
    CHECK(mesh.triangle_count() == 2);
    CHECK(mesh.positions.size() == 4);
    CHECK(surface_area(mesh) == Approx(1));
    // No normals: flat, corners not shared.
    CHECK(mesh.normals.size() == 6);
    for (const Vec3f& n : mesh.normals) CHECK(n == Vec3f(0, 0, 1));
    REQUIRE(mesh.uv_sets.size() == 1);
    const Vec2 uv = mesh.uv(0, {0.25, 0.25});
    const Vec3 p = mesh.position(0, {0.25, 0.25});
    CHECK(uv.x == Approx(p.x));
    CHECK(uv.y == Approx(1 - p.y));
    REQUIRE(scene.materials.size() == 1);
    CHECK(scene.materials[0].name == "default");
  }
}

TEST_CASE("modes: triangles, strips and fans, points and lines are left out with a remark") {
  // The same hexagon fan of six triangles, area 3 sqrt(3) / 2, in each mode.
  const ScratchFolder folder;
  std::vector<float> ring;
  for (int i = 0; i <= 6; ++i)
    ring.insert(ring.end(),
                {static_cast<float>(std::cos(i * pi / 3)), static_cast<float>(std::sin(i * pi / 3)), 0});
  const double area = 1.5 * std::sqrt(3.0);
  TinyGltfFile file;
  SECTION("fan, not indexed") {
    std::vector<float> fan{0, 0, 0};
    fan.insert(fan.end(), ring.begin(), ring.end());
    file.add_mesh({{"POSITION", file.add_accessor(fan, "VEC3")}})["mode"] = 6;
  }
  SECTION("strip of the hexagon's corners") {
    const int positions = file.add_accessor(ring, "VEC3");
    file.add_mesh({{"POSITION", positions}},
                  file.add_accessor<uint8_t>({0, 1, 5, 2, 4, 3}, "SCALAR"))["mode"] = 5;
  }
  SECTION("triangles with 32-bit indices and two left over") {
    const int positions = file.add_accessor(ring, "VEC3");
    file.add_mesh({{"POSITION", positions}},
                  file.add_accessor<uint32_t>({0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 1, 2}, "SCALAR"));
  }
  const int points = file.add_accessor(ring, "VEC3");
  for (const int mode : {0, 1, 2, 3}) file.add_mesh({{"POSITION", points}})["mode"] = mode;
  const GltfScene scene = import_gltf(file.write(folder));
  REQUIRE(scene.objects.size() == 1);
  CHECK(total_area(scene) == Approx(area).epsilon(1e-6));
  for (uint32_t t = 0; t < scene.objects[0].mesh.triangle_count(); ++t)
    CHECK(scene.objects[0].mesh.geometric_normal(t).z == Approx(1));
  CHECK(warned(scene.warnings, "4 primitives of points or lines"));
}

TEST_CASE("nodes: hierarchy, instances, rotations and mirrors") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square();
  // A parent moved by x = 10 and turned a quarter about y, with a child that is the square twice as large
  // along x; beside it a mirrored instance; and one by matrix.
  const double h = std::sqrt(0.5);
  file.root["nodes"] = {
      {{"translation", {10, 0, 0}}, {"rotation", {0, h, 0, h}}, {"children", {1}}, {"name", "parent"}},
      {{"mesh", 0}, {"scale", {2, 1, 1}}, {"name", "child"}},
      {{"mesh", 0}, {"scale", {-1, 1, 1}}, {"name", "mirrored"}},
      {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 7, 1}}}};
  file.root["scenes"][0]["nodes"] = {0, 2, 3};
  const GltfScene scene = import_gltf(file.write(folder));
  REQUIRE(scene.objects.size() == 3);
  const TriangleMesh& child = scene.objects[0].mesh;
  CHECK(scene.objects[0].name == "child");
  // Turned by +90 degrees about y, +x goes to -z and +z to +x.
  const BoundingBox box = bounding_box(child);
  CHECK(box.low.z == Approx(-2));
  CHECK(box.high.z == Approx(0).margin(1e-12));
  CHECK(box.low.x == Approx(10));
  CHECK(child.geometric_normal(0).x == Approx(1));
  const TriangleMesh& mirrored = scene.objects[1].mesh;
  CHECK(bounding_box(mirrored).low.x == Approx(-1));
  // Winding is turned over, so that the square still faces +z.
  CHECK(mirrored.geometric_normal(0).z == Approx(1));
  CHECK(mirrored.normals[0].z == Approx(1));
  CHECK(bounding_box(scene.objects[2].mesh).low.z == Approx(7));
}

TEST_CASE("nodes that the scene does not reach are not shown, without scenes all are") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square();
  file.root["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}});
  file.root["scenes"][0]["nodes"] = {0};
  CHECK(import_gltf(file.write(folder)).objects.size() == 1);
  file.root.erase("scenes");
  file.root.erase("scene");
  CHECK(import_gltf(file.write(folder)).objects.size() == 2);
}

TEST_CASE("normals follow the inverse transpose, tangents the matrix") {
  const ScratchFolder folder;
  TinyGltfFile file;
  const float s = std::sqrt(0.5f);
  const int positions = file.add_accessor<float>({0, 0, 0, 1, 0, -1, 0, 1, 0}, "VEC3");
  const int normals = file.add_accessor<float>({s, 0, s, s, 0, s, s, 0, s}, "VEC3");
  const int tangents = file.add_accessor<float>({s, 0, -s, 1, s, 0, -s, 1, s, 0, -s, 1}, "VEC4");
  const int uvs = file.add_accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  file.add_mesh({{"POSITION", positions},
                 {"NORMAL", normals},
                 {"TANGENT", tangents},
                 {"TEXCOORD_0", uvs}})["material"] = 0;
  const int texture = file.add_texture(png_of({{128, 128, 255, 255}}, 1));
  file.root["materials"] = {{{"normalTexture", {{"index", texture}}}}};
  file.root["nodes"][0]["scale"] = {-3, 1, 1};
  const GltfScene scene = import_gltf(file.write(folder));
  const TriangleMesh& mesh = scene.objects[0].mesh;
  const Vec3 expected = glm::normalize(Vec3(-1.0 / 3, 0, 1));
  CHECK(glm::length(Vec3(mesh.normals[0]) - expected) == Approx(0).margin(1e-6));
  CHECK(glm::dot(mesh.geometric_normal(0), expected) == Approx(1));
  REQUIRE(mesh.tangents.size() == mesh.normals.size());
  const Vec3 tangent = glm::normalize(Vec3(-3, 0, -1));
  CHECK(glm::length(Vec3(mesh.tangents[0]) - tangent) == Approx(0).margin(1e-6));
  CHECK(mesh.tangents[0].w == -1);  // a mirror turns the bitangent over
}

TEST_CASE("tangents are made where a normal map needs them and dropped where none does") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square()["material"] = 0;
  const int texture = file.add_texture(png_of({{128, 128, 255, 255}}, 1));
  file.root["materials"] = {{{"normalTexture", {{"index", texture}}}}};
  const GltfScene with = import_gltf(file.write(folder));
  REQUIRE(with.objects[0].mesh.tangents.size() == with.objects[0].mesh.normals.size());
  CHECK(with.objects[0].mesh.tangents[0].x == Approx(1));
  file.root["materials"] = json::array({json::object()});
  CHECK(import_gltf(file.write(folder)).objects[0].mesh.tangents.empty());
}

TEST_CASE("welding joins primitives and UV splits by position alone") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square();
  // A second primitive on the right of the first, sharing two corners (one of them written as -0).
  const int positions = file.add_accessor<float>({1, -0.0f, 0, 2, 0, 0, 1, 1, 0}, "VEC3");
  file.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", positions}}}});
  const GltfScene scene = import_gltf(file.write(folder));
  REQUIRE(scene.objects.size() == 1);
  CHECK(scene.objects[0].mesh.triangle_count() == 3);
  CHECK(scene.objects[0].mesh.positions.size() == 5);
  // The second primitive has no UVs: it reads (0, 0).
  CHECK(scene.objects[0].mesh.uv(2, {0.3, 0.3}) == Vec2(0, 0));
}

TEST_CASE("COLOR_0 of every component type, with and without alpha") {
  const ScratchFolder folder;
  const auto loaded = [&](auto add) {
    TinyGltfFile file;
    file.add_square();
    const int colours = add(file);
    file.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colours;
    return import_gltf(file.write(folder)).objects.at(0).mesh.colours.at(0);
  };
  const Vec4f floats = loaded([](TinyGltfFile& f) {
    return f.add_accessor<float>({0.25f, 0.5f, 1, 0.25f, 0.5f, 1, 0.25f, 0.5f, 1, 0.25f, 0.5f, 1}, "VEC3");
  });
  CHECK(floats == Vec4f(0.25f, 0.5f, 1, 1));
  const Vec4f bytes = loaded([](TinyGltfFile& f) {
    const std::array<uint8_t, 4> colour{51, 102, 255, 204};
    std::vector<uint8_t> v(16);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = colour[i % 4];
    return f.add_accessor(v, "VEC4", true);
  });
  CHECK(glm::length(bytes - Vec4f(0.2f, 0.4f, 1, 0.8f)) < 1e-6);
  const Vec4f shorts = loaded([](TinyGltfFile& f) {
    const std::array<uint16_t, 4> colour{13107, 26214, 65535, 0};
    std::vector<uint16_t> v(16);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = colour[i % 4];
    return f.add_accessor(v, "VEC4", true);
  });
  CHECK(glm::length(shorts - Vec4f(0.2f, 0.4f, 1, 0)) < 1e-6);
}

TEST_CASE("sparse accessors, with and without a base") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square();
  const int indices = file.add_view<uint8_t>({2, 3});
  const int values = file.add_view<float>({1, 3, 0, 0, 3, 0});
  const json sparse{{"count", 2},
                    {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                    {"values", {{"bufferView", values}}}};
  file.root["accessors"][0]["sparse"] = sparse;
  CHECK(total_area(import_gltf(file.write(folder))) == Approx(3));
  // Without a base all others are zero: (0,0,0), (0,0,0), (1,3,0), (0,3,0).
  file.root["accessors"][0].erase("bufferView");
  CHECK(bounding_box(import_gltf(file.write(folder)).objects[0].mesh).high == Vec3(1, 3, 0));
}

TEST_CASE("quantized positions, normals and UVs (KHR_mesh_quantization)") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  file.root["extensionsUsed"] = {"KHR_mesh_quantization"};
  const int positions = file.add_accessor<uint16_t>({0, 0, 0, 1000, 0, 0, 1000, 1000, 0, 0, 1000, 0}, "VEC3");
  const int normals = file.add_accessor<int8_t>({0, 0, 127, 0, 0, 127, 0, 0, 127, 0, 0, 127}, "VEC3", true);
  const int uvs = file.add_accessor<uint8_t>({0, 255, 255, 255, 255, 0, 0, 0}, "VEC2", true);
  const int indices = file.add_accessor<uint8_t>({0, 1, 2, 0, 2, 3}, "SCALAR");
  file.add_mesh({{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}}, indices);
  file.root["nodes"][0]["scale"] = {0.001, 0.001, 0.001};
  const GltfScene scene = import_gltf(file.write(folder));
  CHECK(total_area(scene) == Approx(1));
  CHECK(scene.objects[0].mesh.normals[0] == Vec3f(0, 0, 1));
  CHECK(scene.objects[0].mesh.uv(0, {0, 0}) == Vec2(0, 1));
}

TEST_CASE("interleaved vertices by byteStride") {
  const ScratchFolder folder;
  TinyGltfFile file;
  // position, uv, position, uv, ...
  const int view = file.add_view<float>({0, 0, 0, 9, 8, 1, 0, 0, 7, 6, 0, 1, 0, 5, 4}, 20);
  file.root["accessors"] = {
      {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
      {{"bufferView", view}, {"byteOffset", 12}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}}};
  file.add_mesh({{"POSITION", 0}, {"TEXCOORD_0", 1}});
  const GltfScene scene = import_gltf(file.write(folder));
  CHECK(total_area(scene) == Approx(0.5));
  CHECK(scene.objects[0].mesh.uv(0, {0, 1}) == Vec2(5, 4));
}

TEST_CASE("morph targets are applied with their default weights, the node's before the mesh's") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square();
  const int target = file.add_accessor<float>({0, 0, 0, 2, 0, 0, 2, 0, 0, 0, 0, 0}, "VEC3");
  file.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", target}}};
  file.root["meshes"][0]["weights"] = {0.5};
  const GltfScene scene = import_gltf(file.write(folder));
  CHECK(total_area(scene) == Approx(2));
  CHECK(warned(scene.warnings, "morph targets"));
  file.root["nodes"][0]["weights"] = {1.0};
  CHECK(total_area(import_gltf(file.write(folder))) == Approx(3));
}

TEST_CASE("a skinned mesh stands in the pose of its joints") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square();
  const int joints = file.add_accessor<uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4");
  // The two vertices at y = 0 follow joint 0, the others joint 1.
  const int weights = file.add_accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4");
  const int bind = file.add_accessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,  //
                                             1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                                            "MAT4");
  auto& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = joints;
  attributes["WEIGHTS_0"] = weights;
  file.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                        {{"name", "root"}, {"children", {2}}},
                        {{"name", "tip"}, {"translation", {0, 5, 0}}}};
  file.root["scenes"][0]["nodes"] = {0, 1};
  file.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", bind}}};
  const GltfScene scene = import_gltf(file.write(folder));
  // Bound at y = 1, now at y = 5: the upper vertices rise by 4; the node's own translation does not count.
  const BoundingBox box = bounding_box(scene.objects[0].mesh);
  CHECK(box.low == Vec3(0, 0, 0));
  CHECK(box.high == Vec3(1, 5, 0));
  CHECK(warned(scene.warnings, "skinned"));
}

TEST_CASE("cameras and lights come with their nodes") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square();
  const double h = std::sqrt(0.5);
  file.root["cameras"] = {
      {{"type", "perspective"}, {"name", "near"}, {"perspective", {{"yfov", pi / 3}, {"znear", 0.1}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 3}, {"znear", 0}, {"zfar", 9}}}}};
  file.root["extensionsUsed"] = {"KHR_lights_punctual"};
  file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", 7}, {"color", {1, 0.5, 0}}},
      {{"type", "directional"}, {"intensity", 3}},
      {{"type", "spot"}, {"intensity", 2}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}}};
  const auto light = [](int index) { return json{{"KHR_lights_punctual", {{"light", index}}}}; };
  file.root["nodes"].push_back(
      {{"camera", 0}, {"name", "eye"}, {"translation", {0, 0, 5}}, {"rotation", {0, h, 0, h}}});
  file.root["nodes"].push_back({{"camera", 1}, {"scale", {4, 4, 4}}});
  file.root["nodes"].push_back({{"extensions", light(0)}, {"translation", {1, 2, 3}}});
  file.root["nodes"].push_back({{"extensions", light(1)}, {"rotation", {-h, 0, 0, h}}});
  file.root["nodes"].push_back({{"extensions", light(2)}});
  file.root["scenes"][0]["nodes"] = {0, 1, 2, 3, 4, 5};
  const GltfScene scene = import_gltf(file.write(folder));
  REQUIRE(scene.cameras.size() == 2);
  CHECK(scene.cameras[0].name == "eye");
  CHECK(scene.cameras[0].alias == "near");
  CHECK(scene.cameras[0].vertical_fov == Approx(60));
  CHECK(scene.cameras[0].direction.x == Approx(-1));
  CHECK(scene.cameras[0].position == Vec3(0, 0, 5));
  CHECK(scene.cameras[1].orthographic_height == Approx(6));
  REQUIRE(scene.lights.size() == 3);
  CHECK(std::get<PointLight>(scene.lights[0]).intensity == Rgb(7, 3.5, 0));
  CHECK(std::get<PointLight>(scene.lights[0]).position == Vec3(1, 2, 3));
  CHECK(std::get<DirectionalLight>(scene.lights[1]).direction.y == Approx(-1));
  CHECK(std::get<SpotLight>(scene.lights[2]).outer_cone == Approx(0.4));
}

TEST_CASE("textures: sRGB for colours only, samplers, transforms and the UV set they name") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square()["material"] = 0;
  const int second = file.add_accessor<float>({0, 0, 0, 0, 0, 0, 0, 0}, "VEC2");
  file.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = 1;
  file.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = second;
  const int texture = file.add_texture(png_of({{188, 0, 255, 128}, {255, 255, 255, 255}}, 2));
  file.root["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  file.root["textures"][0]["sampler"] = 0;
  file.root["extensionsUsed"] = {"KHR_texture_transform"};
  file.root["extensionsRequired"] = {"KHR_texture_transform"};
  file.root["materials"] = {
      {{"name", "painted"},
       {"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", texture},
           {"texCoord", 0},
           {"extensions",
            {{"KHR_texture_transform",
              {{"offset", {0.5, 0}}, {"scale", {0.5, 2}}, {"rotation", 0.3}, {"texCoord", 1}}}}}}},
         {"metallicRoughnessTexture", {{"index", texture}}},
         {"metallicFactor", 0.25}}}}};
  const GltfScene scene = import_gltf(file.write(folder));
  const Material& material = scene.materials.at(0);
  REQUIRE(material.base_colour);
  CHECK(material.base_colour->texels().at(0, 0).r == Approx(0.5029).epsilon(0.001));  // sRGB 188
  CHECK(material.base_colour->texels().at(0, 0).a == Approx(128 / 255.0));
  CHECK(material.metallic_roughness->texels().at(0, 0).r == Approx(188 / 255.0));
  const TextureMapping& mapping = material.base_colour->mapping();
  CHECK(mapping.wrap_u == Wrap::clamp);
  CHECK(mapping.wrap_v == Wrap::mirror);
  CHECK(mapping.filter == Filter::nearest);
  CHECK(mapping.offset == Vec2(0.5, 0));
  CHECK(mapping.scale == Vec2(0.5, 2));
  CHECK(mapping.rotation == Approx(0.3));
  // The base colour's set is brought to 0, what was set 0 goes where it was.
  CHECK(mapping.uv_set == 0);
  CHECK(material.metallic_roughness->mapping().uv_set == 1);
  CHECK(scene.objects[0].mesh.uv(0, {0, 0}, 0) == Vec2(0, 1));
  CHECK(scene.objects[0].mesh.uv(0, {0, 0}, 1) == Vec2(0, 0));
}

TEST_CASE("WebP pictures by EXT_texture_webp are preferred to their fallback") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square()["material"] = 0;
  const std::array<uint8_t, 4> pixel{10, 200, 30, 255};
  uint8_t* encoded = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(pixel.data(), 1, 1, 4, &encoded);
  REQUIRE(size > 0);
  const int view = file.add_view(std::vector<uint8_t>(encoded, encoded + size));
  WebPFree(encoded);
  const int texture = file.add_texture(png_of({{255, 0, 0, 255}}, 1));
  file.root["images"].push_back({{"bufferView", view}, {"mimeType", "image/webp"}});
  file.root["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 1;
  file.root["extensionsRequired"] = {"EXT_texture_webp"};
  file.root["extensionsUsed"] = {"EXT_texture_webp"};
  file.root["materials"] = {{{"occlusionTexture", {{"index", texture}}},
                             {"pbrMetallicRoughness", {{"metallicRoughnessTexture", {{"index", texture}}}}}}};
  const Material material = import_gltf(file.write(folder)).materials.at(0);
  CHECK(material.metallic_roughness->texels().at(0, 0).g == Approx(200 / 255.0));
}

TEST_CASE("material extensions: ior, emissive strength, alpha modes") {
  const ScratchFolder folder;
  TinyGltfFile file;
  file.add_square()["material"] = 0;
  file.root["materials"] = {{{"emissiveFactor", {1, 0.5, 0}},
                             {"alphaMode", "MASK"},
                             {"alphaCutoff", 0.25},
                             {"doubleSided", true},
                             {"extensions",
                              {{"KHR_materials_ior", {{"ior", 1.33}}},
                               {"KHR_materials_emissive_strength", {{"emissiveStrength", 6}}}}}}};
  const Material material = import_gltf(file.write(folder)).materials.at(0);
  CHECK(material.ior == Approx(1.33));
  CHECK(material.emission == Rgb(6, 3, 0));
  CHECK(material.alpha_mode == AlphaMode::mask);
  CHECK(material.alpha_cutoff == 0.25);
  CHECK(material.double_sided);
}
