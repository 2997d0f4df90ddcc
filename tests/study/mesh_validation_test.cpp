#include "study/mesh_validation.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "image/exr_file.h"
#include "study/scene_fingerprint.h"
#include "study/validation.h"
#include "support/paths.h"
#include "support/z_test.h"

using namespace alabaster;

namespace {

Image flat_image(int size, double value, double variance) {
  Image image(size, size, {"R", "G", "B", "A", "variance.R", "variance.G", "variance.B", "samples.Y"});
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      image.set_rgb(0, x, y, Rgb(value));
      image.set_rgb(4, x, y, Rgb(variance));
      image.at(7, x, y) = 4;
    }
  return image;
}

}  // namespace

TEST_CASE("names of mesh methods are read and written back") {
  CHECK(parse_mesh_method("composite").name == "composite+half-space");
  CHECK(parse_mesh_method("composite:symmetric").name == "composite+half-space+symmetric");
  CHECK(parse_mesh_method("composite+shape+view").model == "composite:view");
  const MeshMethod method = parse_mesh_method("composite+half-space+order1");
  CHECK(method.model == "composite:order1");
  CHECK(method.basis == "half-space");
  CHECK(parse_mesh_method("composite+shape+symmetric+arc").placement == "arc");
  CHECK(parse_mesh_method("aggregate+half-space+straightest").name == "aggregate+half-space+straightest");
  CHECK(parse_mesh_method("composite+half-space+chord").name == "composite+half-space");
  CHECK(parse_mesh_method("composite+half-space+chord+chord").name == "composite+half-space");
  CHECK(parse_mesh_method("composite+shape+order1+arc+geodesic").name ==
        "composite+shape+order1+arc+geodesic");
  CHECK(parse_mesh_method("homogeneous+shape+normal-corrected").distance == "normal-corrected");
  CHECK(parse_mesh_method("walk").transport == Transport::walk);
  CHECK(parse_mesh_method("volume").transport == Transport::volume);
  for (const char* wrong :
       {"", "walk+half-space", "composite+", "composite+sphere", "factorized+half-space+order1",
        "factorized+half-space+arc", "walk+geodesic", "composite+half-space+order1+order1"})
    CHECK_THROWS_AS(parse_mesh_method(wrong), InputError);
  for (const MeshMethod& m : standard_mesh_methods()) CHECK(parse_mesh_method(m.name).name == m.name);
  CHECK(standard_mesh_methods().size() == 4 * mesh_bases().size() + 2);
}

TEST_CASE("meshes are told from flat scenes by their names") {
  const ScratchFolder folder;
  write_text_atomically(folder / "flat.json", R"({"version": 1, "texture": {"file": "a.png"}})");
  write_text_atomically(folder / "mesh.json", R"({"version": 1, "model": "a.glb"})");
  CHECK(is_mesh_scene_name("mesh"));
  CHECK(is_mesh_scene_name("sphere_10"));
  CHECK(is_mesh_scene_name("some/Model.GLB"));
  CHECK(is_mesh_scene_name((folder / "mesh.json").string()));
  CHECK_FALSE(is_mesh_scene_name((folder / "flat.json").string()));
  CHECK_FALSE(is_mesh_scene_name("stripes1@45"));
  CHECK_THROWS_AS(is_mesh_scene_name("not-there.json"), InputError);
  CHECK(expand_mesh_scenes({"slab_2", "a.glb", "sphere_3", "a.glb"}) ==
        std::vector<std::string>{"sphere_3", "slab_2", "a.glb"});
  CHECK(expand_mesh_scenes({"mesh"}).size() >= 12);
}

TEST_CASE("a fingerprint knows what decides the image") {
  MeshScene scene = load_mesh_scene("sphere_3", 8);
  const std::string first = scene_fingerprint(scene.scene);
  CHECK(first.size() == 32);
  CHECK(scene_fingerprint(load_mesh_scene("sphere_3", 16).scene) == first);  // the size is not its matter
  const auto differs = [&](auto change) {
    MeshScene other = load_mesh_scene("sphere_3", 8);
    change(other.scene);
    return scene_fingerprint(other.scene) != first;
  };
  CHECK(differs([](Scene& s) { s.cameras.front().vertical_fov += 1e-3; }));
  CHECK(differs([](Scene& s) { s.objects.front().mesh.positions[5].x += 1e-9; }));
  CHECK(differs([](Scene& s) { s.materials.front().medium->mean_free_path.g *= 1.001; }));
  CHECK(differs([](Scene& s) { s.environment = make_constant_environment(Rgb(1)); }));
  CHECK(differs([](Scene& s) { s.lights.push_back(DiskLight{Vec3(0), Vec3(0, 1, 0), 1, Rgb(1)}); }));
  CHECK(differs([](Scene& s) { flatten_albedo(s); }));
}

TEST_CASE("a flattened scene has one albedo, the mean of its texture") {
  MeshScene scene = load_mesh_scene("sphere_10", 8);
  SceneObject& object = scene.scene.objects.front();
  flatten_albedo(scene.scene);
  const Rgb albedo = object.albedo->max();
  CHECK(albedo.r == Approx(0.725).margin(0.01));  // half 0.95, half 0.5
  CHECK(object.albedo->at(object.mesh.surface_point(7, Vec2(0.2))) == albedo);
}

TEST_CASE("merged images weigh by samples, and their variances by its square") {
  const TimedImage a{flat_image(2, 1, 0.4), 1, 2, 30}, b{flat_image(2, 3, 0.2), 10, 20, 10};
  const TimedImage m = merged(a, b);
  CHECK(m.image.at(0, 1, 1) == Approx(1.5));
  CHECK(m.image.at(5, 0, 1) == Approx(0.4 * 9 / 16 + 0.2 / 16));
  CHECK(m.image.at(7, 0, 0) == 8);
  CHECK(m.samples == 40);
  CHECK(m.cpu_seconds == 22);
}

TEST_CASE("references are kept, taken when good enough, and continued when not") {
  const ScratchFolder folder;
  const MeshScene scene = load_mesh_scene("sphere_30", 8);
  ReferenceStore store(folder.path());
  const ReferenceGoal rough{0.001, 8, 1};
  const auto first = store.get(scene, false, rough);
  REQUIRE(first);
  CHECK(first->samples == 8 * 64);
  const auto file = store.file_of(scene, false, 1);
  REQUIRE(std::filesystem::exists(file));
  // Marked by hand: whoever takes it from the folder finds the mark.
  ExrFile kept = read_exr(file);
  kept.image.at(0, 0, 0) = 123;
  write_exr(file, kept.image, kept.attributes);
  CHECK(store.get(scene, false, rough)->image.at(0, 0, 0) == 123);
  CHECK(store.get(scene, false, {10, 4, 1})->image.at(0, 0, 0) == 123);

  std::filesystem::remove(file);
  store.get(scene, false, rough);
  const auto better = store.get(scene, false, {0.001, 40, 1});
  CHECK(better->samples == 40 * 64);
  CHECK(noise_of(better->image) < noise_of(first->image));
  CHECK(better->image.at(better->image.find("samples.Y"), 3, 3) == 40);

  CHECK(store.file_of(scene, true, 1) != file);
  CHECK(store.file_of(scene, false, 2) != file);
  CHECK(store.file_of(load_mesh_scene("sphere_30", 16), false, 1) != file);
  write_text_atomically(file, "damaged");
  CHECK(store.get(scene, false, rough)->image.at(0, 0, 0) != 123);
}

TEST_CASE("on one albedo, walks that do not ask for the closest point are the reference") {
  const ScratchFolder folder;
  MeshScene scene = load_mesh_scene("sphere_10", 12);
  flatten_albedo(scene.scene);
  ReferenceStore store(folder.path());
  const ReferenceGoal goal{0, 256, 1};
  const auto asking = store.get(scene, false, goal), plain = store.get(scene, true, {0, 256, 2});
  const ZTest test = z_test(asking->image, plain->image, 15);
  INFO(test.where);
  CHECK(test.passes(1e-4));
}

TEST_CASE("the part of an error that is the shape's is divided out") {
  // Truth 1; the method 0.5 with and without texture: aggregation adds nothing.
  const Image method = flat_image(8, 0.5, 1e-6), flat_method = flat_image(8, 0.4, 1e-6),
              flat_truth = flat_image(8, 0.8, 1e-6);
  const CorrectedImage image = corrected(method, flat_truth, flat_method);
  CHECK(image.image.at(1, 3, 3) == Approx(1));
  // (0.5 * 0.8 / 0.4)^2 * (1e-6 / 0.5^2 + 1e-6 / 0.8^2 + 1e-6 / 0.4^2)
  CHECK(image.image.at(3, 3, 3) == Approx(1e-6 * (4 + 1 / 0.64 + 1 / 0.16)));
  CHECK(std::count(image.known.begin(), image.known.end(), true) == 64);
  const CorrectedImage unknown = corrected(method, flat_truth, flat_image(8, 0.4, 0.01));
  CHECK(std::count(unknown.known.begin(), unknown.known.end(), true) == 0);
}

TEST_CASE("meshes are validated with rows, images and a page") {
  const ScratchFolder folder;
  ValidationOptions options;
  options.scenes = {"sphere_10"};
  options.output = folder / "report";
  options.cache = folder / "cache";
  options.mesh_budget = MeshBudget{12, 0.1, 64, 16};
  const ValidationResult result = validate(options);
  REQUIRE(result.meshes.size() == 1);
  const auto rows = nlohmann::json::parse(read_text(options.output / "results.json"));
  REQUIRE(rows.size() == standard_mesh_methods().size());
  for (const auto& row : rows) {
    CHECK(row.at("scene") == "sphere_10");
    for (const char* key :
         {"model", "rmse_over_rms", "bias", "noise", "mean_bias", "mean_abs_log_ratio", "kept", "seconds",
          "cpu_seconds", "samples", "shape_bias", "aggregation_bias", "sampling_noise", "reference_noise"})
      CHECK(row.contains(key));
    const std::string model = row.at("model");
    CHECK(std::filesystem::exists(options.output / "sphere_10" / (model + ".exr")));
    CHECK(row.at("samples") == 16 * 144);
    // A planar basis on a sphere of 10 mean free paths is 15 to 30 % too dark, whatever the texture.
    if (model.find("half-space") != std::string::npos) CHECK(row.at("shape_mean_bias").get<double>() < -0.05);
  }
  CHECK(rows[0].at("shape_bias") == rows[3].at("shape_bias"));
  const std::string page = read_text(options.output / "report.html");
  CHECK(page.find("Meshes: errors by cause") != std::string::npos);
  CHECK(page.find("Flat scenes") == std::string::npos);
}

TEST_CASE("scenes that the reference cannot render are left out and named") {
  const MeshScene sheet = [] {
    MeshScene scene = load_mesh_scene("sphere_3", 8);
    scene.scene.objects.front().report.closed = false;
    scene.scene.objects.front().report.border_edges = 3;
    return scene;
  }();
  CHECK(obstacle_to_reference(sheet).find("border") != std::string::npos);
  CHECK(obstacle_to_reference(load_mesh_scene("sphere_3", 8)).empty());
}
