#include "study/scene_sets.h"

#include <catch2/catch.hpp>
#include <set>

#include "core/atomic_file.h"
#include "core/error.h"
#include "geometry/mesh.h"
#include "scene/scene_file.h"
#include "study/demo_recipe.h"
#include "support/paths.h"

using namespace alabaster;

TEST_CASE("the ids of scenes are the agreed ones") {
  const std::vector<std::string> planar{"stripes1",
                                        "stripes2",
                                        "floral",
                                        "escher",
                                        "cork",
                                        "logo",
                                        "colour_bleeding_x0.25",
                                        "colour_bleeding_x0.5",
                                        "colour_bleeding_x1",
                                        "colour_bleeding_x2",
                                        "colour_bleeding_x4"};
  const std::vector<std::string> mesh{"sphere_1",   "sphere_3", "sphere_10",   "sphere_30",
                                      "cylinder_3", "torus",    "ellipsoid_3", "blob",
                                      "fold",       "slab_1",   "slab_2",      "slab_5"};
  CHECK(expand_scene_ids({"planar"}) == planar);
  CHECK(expand_scene_ids({"mesh"}) == mesh);
  CHECK(expand_scene_ids({"fold", "logo", "logo"}) == std::vector<std::string>{"logo", "fold"});
  CHECK_THROWS_WITH(expand_scene_ids({"stripes3"}),
                    Catch::Contains("stripes3") && Catch::Contains("stripes1"));
}

TEST_CASE("flat scenes are [EK17]'s set-up") {
  for (const std::string id : {"stripes2", "cork", "colour_bleeding_x4", "dots"}) {
    INFO(id);
    const PlanarScene scene = make_planar_study_scene(id, 50);
    CHECK_NOTHROW(check(scene));
    CHECK(scene.name == id);
    CHECK(scene.tile == Vec2(10));
    CHECK(scene.albedo->width == 400);
    CHECK(scene.view.width == 50);
  }
  const PlanarScene bleeding = make_planar_study_scene("colour_bleeding_x0.25");
  CHECK(bleeding.medium.mean_free_path == Rgb(4));
  CHECK(bleeding.light.radius == 4);
  CHECK(make_planar_study_scene("dots").light.radius == 1);
  CHECK_THROWS_AS(make_planar_study_scene("torus"), InputError);
}

TEST_CASE("mesh scenes have the size in mean free paths that their ids say") {
  const auto half_extent = [](const char* id, int axis) {
    const SceneRecipe recipe = make_mesh_study_recipe(id);
    REQUIRE(recipe.parts.size() == 1);
    const BoundingBox box = bounding_box(recipe.parts[0].mesh);
    return 0.5 * (box.high - box.low)[axis] / recipe.parts[0].medium->mean_free_path.r;
  };
  CHECK(half_extent("sphere_1", 0) == Approx(1));
  CHECK(half_extent("sphere_30", 2) == Approx(30));
  CHECK(half_extent("cylinder_3", 0) == Approx(3));
  CHECK(half_extent("ellipsoid_3", 1) == Approx(3));
  CHECK(half_extent("ellipsoid_3", 0) == Approx(9));
  CHECK(half_extent("torus", 1) == Approx(3));
  CHECK(half_extent("torus", 0) == Approx(12));
  CHECK(half_extent("slab_2", 1) == Approx(1));
  CHECK(half_extent("fold", 1) == Approx(2.25));  // two layers of 2 and a gap of 0.5
}

TEST_CASE("recipes carry what a render needs") {
  for (const std::string name : {"plane", "cavity", "sphere_1", "blob"}) {
    INFO(name);
    const SceneRecipe recipe = make_recipe(name);
    CHECK(recipe.id == name);
    CHECK(!recipe.title.empty());
    REQUIRE(!recipe.parts.empty());
    CHECK(recipe.parts[0].medium.has_value());
    REQUIRE(recipe.parts[0].texture);
    // The camera sees the object's middle.
    const BoundingBox box = bounding_box(recipe.parts[0].mesh);
    const Vec3 towards = glm::normalize(box.centre() - recipe.camera.position);
    CHECK(glm::dot(towards, recipe.camera.direction) > 0.99);
    CHECK(glm::length(box.centre() - recipe.camera.position) > 0.5 * box.diagonal());
  }
  CHECK_THROWS_WITH(make_recipe("teapot"), Catch::Contains("teapot") && Catch::Contains("demo"));
}

TEST_CASE("the blob comes at any size, the same but for its triangles") {
  const SceneRecipe study = make_mesh_study_recipe("blob"), small = make_blob_recipe(3000, true),
                    plain = make_blob_recipe(3000, false);
  CHECK(small.parts.front().mesh.triangle_count() == 3072);  // 12 x 16^2
  CHECK(small.parts.front().texture->width == study.parts.front().texture->width);
  CHECK(small.parts.front().medium->mean_free_path == study.parts.front().medium->mean_free_path);
  CHECK(glm::length(small.camera.position - study.camera.position) <
        0.02 * glm::length(study.camera.position));
  CHECK(plain.parts.front().mesh.triangle_count() == 3072);
  CHECK(plain.parts.front().texture == nullptr);
}

TEST_CASE("the scenes in assets/ are what generate writes, and load") {
  const std::filesystem::path committed = source_dir() / "assets" / "scenes";
  for (const std::string& name : recipe_names()) {
    INFO(name);
    CHECK(std::filesystem::exists(committed / (name + ".glb")));
    CHECK(std::filesystem::exists(committed / (name + ".json")));
  }
  const ScratchFolder folder;
  write_scene_files(make_recipe("slab_1"), folder.path());
  CHECK(read_text(folder / "slab_1.json") == read_text(committed / "slab_1.json"));

  const LoadedScene demo = load_scene(committed / "demo.json", {});
  REQUIRE(demo.scene.objects.size() == 3);
  CHECK(demo.scene.objects[0].report.closed);
  CHECK(demo.scene.objects[1].report.closed);
  CHECK(demo.scene.materials[0].medium.has_value());
  CHECK(demo.scene.materials[1].medium.has_value());
  CHECK_FALSE(demo.scene.materials[2].medium.has_value());
  CHECK(demo.scene.warnings.empty());
}

TEST_CASE("a recipe in memory and its files describe the same scene") {
  const ScratchFolder folder;
  const SceneRecipe recipe = make_recipe("slab_1");
  write_scene_files(recipe, folder.path());
  const LoadedScene loaded = load_scene(folder / "slab_1.json", {});
  const Scene built = build_scene(recipe);
  REQUIRE(loaded.scene.objects.size() == 1);
  const SceneObject &a = built.objects[0], &b = loaded.scene.objects[0];
  CHECK(a.mesh.triangle_count() == b.mesh.triangle_count());
  CHECK(glm::length(a.bounds.high - b.bounds.high) < 1e-6);
  CHECK(built.materials[0].medium->mean_free_path.g ==
        Approx(loaded.scene.materials[0].medium->mean_free_path.g).epsilon(1e-5));
  // Albedo at the middle of triangles: through reflectance, 8 bits and back. 0.95 returns 0.29, where half a
  // code is 0.002 of reflectance and 0.001 of albedo; 0.5 returns 0.03, where it is 0.0006 and 0.005.
  for (uint32_t t = 0; t < a.mesh.triangle_count(); t += 97) {
    const Rgb exact = a.albedo->at(a.mesh.surface_point(t, Vec2(1.0 / 3)));
    const Rgb through_file = b.albedo->at(b.mesh.surface_point(t, Vec2(1.0 / 3)));
    CHECK(through_file.g == Approx(exact.g).margin(0.01));
  }
}
