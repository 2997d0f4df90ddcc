#include <catch2/catch.hpp>
#include <fstream>
#include <functional>
#include <limits>

#include "core/error.h"
#include "core/progress.h"
#include "core/rng.h"
#include "image/png_file.h"
#include "scene/scene_file.h"
#include "scene/tiny_gltf_file.h"
#include "support/paths.h"

using namespace alabaster;
using json = nlohmann::json;

namespace {

std::string error_of(const std::filesystem::path& path) {
  set_quiet(true);
  std::string message = "no error";
  try {
    load_scene(path, {});
  } catch (const InputError& problem) {
    message = problem.what();
  }
  set_quiet(false);
  return message;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A square with a picture and a material, everything in order.
TinyGltfFile good_file() {
  TinyGltfFile file;
  file.add_square()["material"] = 0;
  const int texture = file.add_texture(encode_png(Pixels8(2, 2, 3)));
  file.root["materials"] = {
      {{"name", "wax"},
       {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}, {"metallicFactor", 0}}}}};
  return file;
}

}  // namespace

TEST_CASE("the file that the refusals below start from is good") {
  const ScratchFolder folder;
  CHECK(error_of(good_file().write(folder)) == "no error");
  CHECK(error_of(good_file().write_glb(folder)) == "no error");
}

TEST_CASE("damaged glTF is refused in one line that names file, place and mend") {
  struct Case {
    const char* name;
    std::function<void(TinyGltfFile&)> harm;
    const char* place;
    const char* detail;
  };
  const std::vector<Case> cases{
      {"no asset", [](auto& f) { f.root.erase("asset"); }, "asset.version", "glTF 2.0"},
      {"old", [](auto& f) { f.root["asset"]["version"] = "1.0"; }, "asset.version", "2.0"},
      {"draco", [](auto& f) { f.root["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
       "extensionsRequired", "KHR_draco_mesh_compression"},
      {"meshopt", [](auto& f) { f.root["extensionsRequired"] = {"EXT_meshopt_compression"}; },
       "extensionsRequired", "EXT_meshopt_compression"},
      {"basisu", [](auto& f) { f.root["extensionsRequired"] = {"KHR_texture_basisu"}; }, "extensionsRequired",
       "KHR_texture_basisu"},
      {"unheard of", [](auto& f) { f.root["extensionsRequired"] = {"ACME_x"}; }, "extensionsRequired",
       "ACME_x"},
      {"scene index", [](auto& f) { f.root["scene"] = 3; }, "scene", "there are 1 scenes"},
      {"node index", [](auto& f) { f.root["scenes"][0]["nodes"] = {7}; }, "scenes[0].nodes",
       "there are 1 nodes"},
      {"negative index", [](auto& f) { f.root["nodes"][0]["mesh"] = -1; }, "nodes[0].mesh", "-1"},
      {"index of wrong type", [](auto& f) { f.root["nodes"][0]["mesh"] = "a"; }, "nodes[0].mesh", "meshes"},
      {"own child", [](auto& f) { f.root["nodes"][0]["children"] = {0}; }, "nodes[0]", "own ancestor"},
      {"ring",
       [](auto& f) {
         f.root["nodes"] = {{{"children", {1}}, {"mesh", 0}}, {{"children", {0}}}};
       },
       "nodes[0]", "own ancestor"},
      {"two parents",
       [](auto& f) {
         f.root["nodes"] = {{{"mesh", 0}}, {{"children", {0}}}, {{"children", {0}}}};
       },
       "nodes[0]", "two parents"},
      {"node not finite",
       [](auto& f) {
         f.root["nodes"][0]["scale"] = {1e308, 1e308, 1e308};
         f.root["nodes"][0]["children"] = {1};
         f.root["nodes"].push_back({{"scale", {1e10, 1, 1}}});
       },
       "nodes[1]", "not finite"},
      {"material index", [](auto& f) { f.root["meshes"][0]["primitives"][0]["material"] = 5; },
       "meshes[0].primitives[0].material", "there are 1 materials"},
      {"accessor index", [](auto& f) { f.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 50; },
       "attributes.POSITION", "accessors"},
      {"no positions", [](auto& f) { f.root["meshes"][0]["primitives"][0]["attributes"].erase("POSITION"); },
       "meshes[0].primitives[0]", "no POSITION"},
      {"no primitives", [](auto& f) { f.root["meshes"][0].erase("primitives"); }, "meshes[0].primitives",
       "missing"},
      {"meshes is no array", [](auto& f) { f.root["meshes"] = 5; }, "meshes", "array"},
      {"mesh is no object", [](auto& f) { f.root["meshes"][0] = 5; }, "meshes[0]", "object"},
      {"view beyond buffer", [](auto& f) { f.root["bufferViews"][0]["byteLength"] = 100000; },
       "bufferViews[0]", "ends at byte"},
      {"view overflow",
       [](auto& f) { f.root["bufferViews"][0]["byteOffset"] = std::numeric_limits<int64_t>::max(); },
       "bufferViews[0]", "its buffer"},
      {"view without buffer", [](auto& f) { f.root["bufferViews"][0].erase("buffer"); },
       "bufferViews[0].buffer", "missing"},
      {"accessor beyond view", [](auto& f) { f.root["accessors"][0]["count"] = 5; }, "POSITION",
       "5 elements"},
      {"accessor offset", [](auto& f) { f.root["accessors"][0]["byteOffset"] = 40; }, "POSITION", "elements"},
      {"enormous count", [](auto& f) { f.root["accessors"][0]["count"] = 4'000'000'000'000; }, "POSITION",
       "elements"},
      {"enormous count without data",
       [](auto& f) {
         f.root["accessors"][0]["count"] = 1'000'000'000;
         f.root["accessors"][0].erase("bufferView");
       },
       "POSITION", "elements"},
      {"negative count", [](auto& f) { f.root["accessors"][0]["count"] = -4; }, "accessors[0].count",
       "whole number"},
      {"component type", [](auto& f) { f.root["accessors"][0]["componentType"] = 1234; }, "", "component"},
      {"positions of two components", [](auto& f) { f.root["accessors"][0]["type"] = "VEC2"; },
       "primitives[0]", "POSITION has 2 components"},
      {"attribute counts differ", [](auto& f) { f.root["accessors"][1]["count"] = 3; }, "primitives[0]",
       "TEXCOORD_0 has 3 elements"},
      {"vertex index",
       [](auto& f) {
         f.root["accessors"][0]["count"] = 3;
         f.root["accessors"][1]["count"] = 3;
       },
       "primitives[0]", "indices name vertex 3"},
      {"float indices", [](auto& f) { f.root["meshes"][0]["primitives"][0]["indices"] = 1; }, "indices",
       "whole numbers"},
      {"sparse index",
       [](auto& f) {
         f.root["accessors"][0]["sparse"] = {
             {"count", 1},
             {"indices", {{"bufferView", f.add_view(std::vector<uint8_t>{9})}, {"componentType", 5121}}},
             {"values", {{"bufferView", 0}}}};
       },
       "POSITION", "sparse value for element 9"},
      {"texture index",
       [](auto& f) { f.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 2; },
       "baseColorTexture.index", "there are 1 textures"},
      {"texture source", [](auto& f) { f.root["textures"][0]["source"] = 2; }, "textures[0].source",
       "there are 1 images"},
      {"texture without source", [](auto& f) { f.root["textures"][0].erase("source"); }, "textures[0]",
       "PNG, JPEG or WebP"},
      {"damaged picture",
       [](auto& f) {
         f.bytes.back() ^= 0xff;
         for (std::size_t i = f.bytes.size() - 60; i < f.bytes.size(); ++i) f.bytes[i] = 7;
       },
       "images[0]", ""},
      {"missing picture",
       [](auto& f) {
         f.root["images"][0] = {{"uri", "none.png"}};
       },
       "images[0] 'none.png'", "beside the model"},
      {"missing buffer",
       [](auto& f) {
         f.bytes.clear();
         f.root["buffers"] = {{{"byteLength", 5000}, {"uri", "no%20ne.bin"}}};
       },
       "buffers[0]", "beside the model"},
      {"broken data URI",
       [](auto& f) {
         f.bytes.clear();
         f.root["buffers"] = {{{"byteLength", 5000}, {"uri", "data:application/octet-stream;base64,!!!"}}};
       },
       "", "glTF 2.0"},
      {"alpha mode", [](auto& f) { f.root["materials"][0]["alphaMode"] = "GLOW"; }, "materials[0]", "GLOW"},
      {"only lines", [](auto& f) { f.root["meshes"][0]["primitives"][0]["mode"] = 3; }, "",
       "points or lines"},
      {"empty scene", [](auto& f) { f.root["scenes"][0].erase("nodes"); }, "", "no triangles"},
      {"nothing at all",
       [](auto& f) {
         f.root = {{"asset", {{"version", "2.0"}}}};
         f.bytes.clear();
       },
       "", "no triangles"},
      {"flat to a point",
       [](auto& f) {
         f.root["nodes"][0]["scale"] = {0, 0, 0};
       },
       "", "model.gltf"},
  };
  for (const Case& c : cases) {
    const ScratchFolder folder;
    TinyGltfFile file = good_file();
    c.harm(file);
    const std::string message = error_of(file.write(folder));
    INFO(c.name << ": " << message);
    CHECK(contains(message, "model.gltf"));
    CHECK(contains(message, c.place));
    CHECK(contains(message, c.detail));
    CHECK_FALSE(contains(message, "\n"));
  }
}

TEST_CASE("positions that are not finite cost their triangles only") {
  const ScratchFolder folder;
  TinyGltfFile file = good_file();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t offset = 3 * 12;  // the fourth vertex belongs to the second triangle only
  std::memcpy(file.bytes.data() + offset, &nan, sizeof nan);
  set_quiet(true);
  const Scene scene = load_scene(file.write(folder), {}).scene;
  set_quiet(false);
  CHECK(scene.objects.at(0).mesh.triangle_count() == 1);
  CHECK(std::any_of(scene.warnings.begin(), scene.warnings.end(),
                    [](const std::string& w) { return contains(w, "not finite"); }));
}

TEST_CASE("cut or foreign files are refused") {
  const ScratchFolder folder;
  const auto text_file = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
    return error_of(folder / name);
  };
  CHECK(contains(text_file("empty.glb", ""), "is empty"));
  CHECK(contains(text_file("empty.gltf", ""), "is empty"));
  CHECK(contains(text_file("short.glb", "glTF"), "cut short"));
  CHECK(contains(text_file("text.glb", "hello"), "line 1, column 1"));
  CHECK(contains(text_file("old.glb", std::string("glTF\x01\0\0\0\x14\0\0\0\0\0\0\0\0\0\0\0", 20)),
                 "version 1"));
  CHECK(
      contains(text_file("binary.glb", std::string("glTF\x02\0\0\0\x14\0\0\0\xff\xff\0\0JSON", 20)), "JSON"));
  CHECK(contains(error_of(folder / "missing.glb"), "cannot be read"));
  // Whatever is missing at the end, the answer is one line.
  const std::size_t size = std::filesystem::file_size(good_file().write_glb(folder));
  for (const std::size_t cut :
       {std::size_t{1}, std::size_t{100}, size / 2, size - 30, size - 21, size - 13, size - 5}) {
    const std::string message = error_of(good_file().write_glb(folder, cut));
    INFO(cut << ": " << message);
    CHECK(contains(message, "cut short"));
    CHECK_FALSE(contains(message, "\n"));
  }
}

TEST_CASE("any byte of a file may be wrong without a crash") {
  // A fuzz test with fixed seeds: outcomes are a scene or an InputError, nothing else.
  const ScratchFolder folder;
  const auto path = good_file().write_glb(folder);
  std::string original;
  {
    std::ifstream in(path, std::ios::binary);
    original.assign(std::istreambuf_iterator<char>(in), {});
  }
  Rng rng(2024);
  int loaded = 0, refused = 0;
  for (int round = 0; round < 400; ++round) {
    std::string bytes = original;
    const int changes = 1 + static_cast<int>(rng.uniform() * 3);
    for (int i = 0; i < changes; ++i)
      bytes[static_cast<std::size_t>(rng.uniform() * static_cast<double>(bytes.size()))] =
          static_cast<char>(rng.next());
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    const std::string message = error_of(path);
    (message == "no error" ? loaded : refused) += 1;
    REQUIRE_FALSE(contains(message, "\n"));
  }
  CHECK(loaded > 0);
  CHECK(refused > 0);
}
