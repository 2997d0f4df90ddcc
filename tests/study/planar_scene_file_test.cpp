#include "study/planar_scene_file.h"

#include <catch2/catch.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "image/png_file.h"
#include "support/paths.h"

using namespace alabaster;

namespace {

// 2 x 1 pixels: black, and the grey whose sRGB decoding is 0.2158605.
void write_texture(const std::filesystem::path& path) {
  Pixels8 pixels(2, 1, 3);
  pixels.bytes = {0, 0, 0, 128, 128, 128};
  write_png(path, pixels);
}

std::string refusal(const std::filesystem::path& file, const std::string& text) {
  write_text_atomically(file, text);
  try {
    load_planar_scene(file, 50);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a scene file brings a picture, its width, light and view") {
  ScratchFolder folder;
  write_texture(folder / "grey.png");
  write_text_atomically(folder / "mine.json", R"({"version": 1, "title": "Mine",
    "texture": {"file": "grey.png", "meaning": "reflectance", "width": 8},
    "light": {"type": "square", "position": [1, 2, 0], "radius": 0.5, "radiance": [1, 2, 3]},
    "view": {"width": 4, "height": 2, "direction": [1, 0, -1], "pixels": 40}})");
  const PlanarScene scene = load_planar_scene(folder / "mine.json", 50);
  CHECK(scene.name == "mine");
  CHECK(scene.title == "Mine");
  CHECK(scene.tile == Vec2(8, 4));
  CHECK(scene.light.shape == PlanarLight::Shape::square);
  CHECK(scene.light.centre == Vec2(1, 2));
  CHECK(scene.light.radiance == Rgb(1, 2, 3));
  CHECK(scene.view.width == 40);
  CHECK(scene.view.height == 20);
  CHECK(scene.view.towards.x == Approx(-std::sqrt(0.5)));
  CHECK(scene.view.towards.z == Approx(std::sqrt(0.5)));
  // The picture is a wanted reflectance: the albedo is the one that gives it.
  const double albedo = static_cast<double>(scene.albedo->at(1, 0).x);
  CHECK(baseline_profile().reflectance(albedo) == Approx(0.2158605).epsilon(1e-3));
  CHECK(scene.albedo->at(0, 0).x == Approx(0).margin(1e-6));
}

TEST_CASE("an albedo picture is taken as it is") {
  ScratchFolder folder;
  write_texture(folder / "grey.png");
  write_text_atomically(folder / "a.json",
                        R"({"version": 1, "texture": {"file": "grey.png", "meaning": "albedo"}})");
  const PlanarScene scene = load_planar_scene(folder / "a.json", 50);
  CHECK(scene.albedo->at(1, 0).x == Approx(128 / 255.0));
  CHECK(scene.view.width == 50);
}

TEST_CASE("mistakes in a scene file are named with their place") {
  ScratchFolder folder;
  write_texture(folder / "grey.png");
  const auto file = folder / "bad.json";
  CHECK_THAT(refusal(file, R"({"version": 1})"), Catch::Contains("bad.json: texture"));
  CHECK_THAT(refusal(file, R"({"version": 1, "texture": {"file": "grey.png", "widht": 3}})"),
             Catch::Contains("texture") && Catch::Contains("width"));
  CHECK_THAT(refusal(file, R"({"version": 1, "texture": {"file": "none.png"}})"),
             Catch::Contains("none.png"));
  CHECK_THAT(refusal(file, R"({"version": 1, "texture": {"file": "grey.png"}, "light": {"type": "star"}})"),
             Catch::Contains("light.type"));
  CHECK_THAT(
      refusal(file, R"({"version": 1, "texture": {"file": "grey.png"}, "view": {"direction": [0, 0, 1]}})"),
      Catch::Contains("view.direction"));
  CHECK_THAT(refusal(file, R"({"version": 1, "texture": {"file": "grey.png"}, "medium": {"g": 1.5}})"),
             Catch::Contains("medium") && Catch::Contains("g") && Catch::Contains("0.99"));
}

TEST_CASE("scenes are named by id, set, file and view") {
  const auto scenes = planar_scenes({"stripes1@45", "stripes1", "stripes1@radiosity", "stripes1"}, 20);
  REQUIRE(scenes.size() == 3);
  CHECK(scenes[0].name == "stripes1@45");
  CHECK(scenes[0].view.towards.x == Approx(std::sqrt(0.5)));
  CHECK(scenes[1].view.towards == Vec3(0, 0, 1));
  CHECK(scenes[2].view.radiosity);
  CHECK_THROWS_AS(planar_scenes({"stripes1@95"}, 10), InputError);
  CHECK_THROWS_AS(planar_scenes({"stripes1@left"}, 10), InputError);
  CHECK_THROWS_AS(planar_scenes({"sphere_3"}, 10), InputError);
  CHECK_THROWS_AS(planar_scenes({"nothing"}, 10), InputError);
}
