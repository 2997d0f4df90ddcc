#include "scene/scene_file.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "core/error.h"
#include "core/progress.h"
#include "image/exr_file.h"
#include "image/png_file.h"
#include "optics/profile_table.h"
#include "scene/tiny_gltf_file.h"
#include "support/paths.h"

using namespace alabaster;
using json = nlohmann::json;

namespace {

/// A closed box with one dielectric material, "wax", in model.gltf, and scene files around it.
class SceneFolder {
 public:
  SceneFolder() {
    set_quiet(true);
    const int positions = box_.add_accessor<float>(
        {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1}, "VEC3");
    const int indices = box_.add_accessor<uint8_t>({0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                                    1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7},
                                                   "SCALAR");
    box_.add_mesh({{"POSITION", positions}}, indices)["material"] = 0;
    box_.root["materials"] = {
        {{"name", "wax"},
         {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 0.99, 1}}, {"metallicFactor", 0}}}}};
    box_.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    box_.root["nodes"].push_back({{"camera", 0}, {"name", "side"}, {"translation", {0.5, 0.5, 5}}});
    box_.root["scenes"][0]["nodes"] = {0, 1};
    write_model();
  }
  ~SceneFolder() { set_quiet(false); }

  void write_model() { box_.write(folder_); }
  LoadedScene load(const json& scene, const LoadOptions& options = {}) {
    std::ofstream(folder_ / "scene.json") << scene.dump(2);
    return load_scene(folder_ / "scene.json", options);
  }
  LoadedScene bare(const LoadOptions& options = {}) { return load_scene(folder_ / "model.gltf", options); }
  std::string error_of_text(const std::string& text) {
    std::ofstream(folder_ / "scene.json") << text;
    try {
      load_scene(folder_ / "scene.json", {});
    } catch (const InputError& problem) {
      return problem.what();
    }
    return "no error";
  }
  std::string error(const json& scene) { return error_of_text(scene.dump()); }

  ScratchFolder folder_;
  TinyGltfFile box_;
};

json with(const std::string& key, const json& value) {
  json scene{{"version", 1}, {"model", "model.gltf"}};
  scene[key] = value;
  return scene;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a bare model gets a medium by the default rule, a camera and the sky") {
  SceneFolder folder;
  const Scene scene = folder.bare().scene;
  const Material& wax = scene.materials.at(0);
  REQUIRE(wax.medium.has_value());
  CHECK(wax.medium->mean_free_path.r == Approx(0.005 * std::sqrt(3.0)));
  CHECK(wax.medium->g == 0.3);
  CHECK(wax.medium->eta == 1.5);
  CHECK(contains(wax.medium_reason, "default rule"));
  REQUIRE(scene.objects.at(0).albedo);
  const Rgb albedo = scene.objects[0].albedo->at({});
  const ProfileTable& profile = baseline_profile();
  CHECK(albedo.r == Approx(profile.albedo_from_reflectance(0.5)));
  CHECK(albedo.g == Approx(profile.albedo_from_reflectance(0.25)));
  CHECK(albedo.b == Approx(profile.albedo_from_reflectance(0.98)));  // clamped, with a warning
  CHECK(wax.mean_albedo->r == Approx(albedo.r));
  CHECK(std::count_if(scene.warnings.begin(), scene.warnings.end(),
                      [](const std::string& w) { return contains(w, "clamped"); }) == 1);
  CHECK(scene.cameras.at(0).name == "side");
  REQUIRE(scene.environment);
  CHECK(scene.environment_visible);
  CHECK(scene.environment->radiance({0, -1, 0}).r == Approx(0.15));
  CHECK(scene.objects[0].report.closed);
  CHECK(scene.objects[0].bounding_radius == Approx(std::sqrt(0.75)));
}

TEST_CASE("a model without a camera is framed: near half the picture, nothing cut off") {
  SceneFolder folder;
  folder.box_.root["nodes"].erase(1);
  folder.box_.root["scenes"][0]["nodes"] = {0};
  folder.write_model();
  const Scene scene = folder.bare().scene;
  const Camera& camera = scene.cameras.at(0);
  int hits = 0, border = 0;
  const int n = 100;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const bool hit = scene.rays.nearest(camera.ray({x + 0.5, y + 0.5}, n, n)).has_value();
      hits += hit ? 1 : 0;
      border += hit && (x == 0 || y == 0 || x == n - 1 || y == n - 1) ? 1 : 0;
    }
  CHECK(hits / double(n * n) == Approx(0.45).margin(0.02));
  CHECK(border == 0);
}

TEST_CASE("cameras look where they are told") {
  SceneFolder folder;
  const Scene scene =
      folder.load(with("camera", {{"position", {1, 2, 3}}, {"target", {1, 2, -7}}, {"vertical_fov", 90}}))
          .scene;
  const Camera& camera = scene.cameras.at(0);
  const Ray middle = camera.ray({50, 25}, 100, 50);
  CHECK(middle.origin == Vec3(1, 2, 3));
  CHECK(glm::length(middle.direction - Vec3(0, 0, -1)) == Approx(0).margin(1e-12));
  const Ray top = camera.ray({50, 0}, 100, 50);
  CHECK(top.direction.y == Approx(std::sqrt(0.5)));
  CHECK(top.direction.x == Approx(0).margin(1e-12));
  const Ray right = camera.ray({100, 25}, 100, 50);
  CHECK(right.direction.x / -right.direction.z == Approx(2));  // twice as wide as high
  Camera flat = camera;
  flat.orthographic_height = 4;
  CHECK(flat.ray({0, 0}, 100, 50).origin == Vec3(1 - 4, 2 + 2, 3));
  CHECK(flat.ray({0, 0}, 100, 50).direction == camera.direction);

  CHECK(folder.load(with("camera", {{"node", "side"}})).scene.cameras.at(0).name == "side");
  LoadOptions options;
  options.camera = "side";
  CHECK(folder.load(with("camera", {{"position", {0, 0, 9}}, {"direction", {0, 0, -1}}}), options)
            .scene.cameras.at(0)
            .name == "side");
}

TEST_CASE("materials: precedence of *, name and options") {
  SceneFolder folder;
  const json materials{
      {"*", {{"mean_free_path", 0.5}, {"g", 0.1}, {"eta", 1.3}}},
      {"wax",
       {{"mean_free_path", {0.1, 0.2, 0.4}}, {"density", 2}, {"albedo", {0.9, 1, 0}}, {"roughness", 0.7}}}};
  Scene scene = folder.load(with("materials", materials)).scene;
  Material wax = scene.materials.at(0);
  REQUIRE(wax.medium.has_value());
  CHECK(wax.medium->mean_free_path == Rgb(0.05, 0.1, 0.2));
  CHECK(wax.medium->g == 0.1);
  CHECK(wax.medium->eta == 1.3);
  CHECK(wax.roughness_factor == 0.7);
  CHECK(scene.objects[0].albedo->at({}) == Rgb(0.9, 1, 0));

  LoadOptions options;
  options.mean_free_path = parse_length("10%");
  options.g = 0.6;
  options.eta = 1.4;
  wax = folder.load(with("materials", materials), options).scene.materials.at(0);
  CHECK(wax.medium->mean_free_path.g == Approx(0.1 * std::sqrt(3.0)));
  CHECK(wax.medium->g == 0.6);
  CHECK(wax.medium->eta == 1.4);

  wax = folder.load(with("materials", {{"wax", {{"subsurface", false}}}})).scene.materials.at(0);
  CHECK_FALSE(wax.medium.has_value());
  CHECK(contains(wax.medium_reason, "scene file"));
  scene = folder.load(with("materials", {{"*", {{"mean_free_path", "1%"}}}})).scene;
  CHECK(scene.materials[0].medium->mean_free_path.r == Approx(0.01 * std::sqrt(3.0)));
}

TEST_CASE("the default rule passes over metals, blending and transmission, names override it") {
  SceneFolder folder;
  auto& material = folder.box_.root["materials"][0];
  const auto reason = [&](const LoadOptions& options = {}) {
    folder.write_model();
    const Scene scene = folder.bare(options).scene;
    CHECK(scene.materials.at(0).medium.has_value() == contains(scene.materials[0].medium_reason, "medium:"));
    CHECK((scene.objects[0].albedo != nullptr) == scene.materials[0].medium.has_value());
    return scene.materials[0].medium_reason;
  };
  material["alphaMode"] = "BLEND";
  CHECK(reason() == "opaque: alphaMode BLEND");
  material["alphaMode"] = "MASK";
  CHECK(contains(reason(), "medium:"));
  material["pbrMetallicRoughness"]["metallicFactor"] = 0.5;
  CHECK(reason() == "opaque: mean metallic 0.5");
  LoadOptions options;
  options.subsurface = {"wax"};
  CHECK(contains(reason(options), "--subsurface"));
  // A metallic texture counts with its mean: 3/4 of the texels are metal, times 0.6 is below one half.
  Pixels8 picture(4, 1, 3);
  for (int x = 0; x < 3; ++x) picture.at(x, 0)[2] = 255;
  material["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"] =
      folder.box_.add_texture(encode_png(picture));
  material["pbrMetallicRoughness"]["metallicFactor"] = 0.6;
  CHECK(contains(reason(), "medium:"));
  material["pbrMetallicRoughness"]["metallicFactor"] = 1;
  CHECK(reason() == "opaque: mean metallic 0.75");
}

TEST_CASE("naming a material that does not exist suggests one that does") {
  SceneFolder folder;
  LoadOptions options;
  options.subsurface = {"wac"};
  CHECK_THROWS_WITH(folder.bare(options), Catch::Contains("did you mean 'wax'?"));
  CHECK_THROWS_WITH(folder.load(with("materials", {{"stone", json::object()}})),
                    Catch::Contains("no material 'stone'"));
}

TEST_CASE("extension media: scattering by multi-scatter colour, glass, thin walls") {
  SceneFolder folder;
  auto& extensions = folder.box_.root["materials"][0]["extensions"];
  const auto load = [&] {
    folder.write_model();
    return folder.bare().scene;
  };
  // sigma_t = -ln(c) / d: e^-2 over 0.1 m is 20 per metre.
  const double c = std::exp(-2.0);
  extensions["KHR_materials_volume"] = {
      {"thicknessFactor", 1}, {"attenuationDistance", 0.1}, {"attenuationColor", {c, c, c * c}}};
  for (const char* name : {"KHR_materials_volume_scatter", "KHR_materials_scatter"}) {
    extensions[name] = {{"multiscatterColorFactor", {0.42, 1, 0}}, {"scatterAnisotropy", 0.3}};
    const Scene scene = load();
    const Material& wax = scene.materials[0];
    REQUIRE(wax.medium.has_value());
    CHECK(wax.medium->mean_free_path.r == Approx(0.05));
    CHECK(wax.medium->mean_free_path.b == Approx(0.025));
    CHECK(wax.medium->g == Approx(0.3));
    const Rgb albedo = scene.objects[0].albedo->at({});
    CHECK(albedo.r == Approx(0.9).margin(0.005));  // 0.42 belongs to alpha 0.9 at g 0.3
    CHECK(albedo.g == Approx(albedo_from_multiscatter(0.98, 0.3)));
    CHECK(albedo.b == Approx(0).margin(1e-4));
    extensions.erase(name);
  }
  // The draft's default colour is black: it absorbs and does not scatter.
  extensions["KHR_materials_volume_scatter"] = json::object();
  CHECK(load().objects[0].albedo->max().max() == Approx(0).margin(1e-4));
  // scatterStrength scales the colour.
  extensions["KHR_materials_volume_scatter"] = {{"multiscatterColor", {0.8, 0.8, 0.8}},
                                                {"scatterStrength", 0.5}};
  CHECK(load().objects[0].albedo->at({}).r == Approx(albedo_from_multiscatter(0.4, 0)));
  // Without attenuation there is no medium.
  extensions["KHR_materials_volume"] = {{"thicknessFactor", 1}};
  CHECK_FALSE(load().materials[0].medium.has_value());

  extensions.clear();
  extensions["KHR_materials_transmission"] = {{"transmissionFactor", 1}};
  extensions["KHR_materials_volume"] = {
      {"thicknessFactor", 1}, {"attenuationDistance", 0.1}, {"attenuationColor", {c, 1, 1}}};
  Scene glass = load();
  REQUIRE(glass.materials[0].medium.has_value());
  CHECK(contains(glass.materials[0].medium_reason, "glass"));
  CHECK(glass.materials[0].medium->mean_free_path.r == Approx(0.05));
  CHECK(glass.materials[0].medium->mean_free_path.g > 1e4);
  CHECK(glass.objects[0].albedo->max() == Rgb(0));
  extensions["KHR_materials_volume"]["thicknessFactor"] = 0;
  glass = load();
  CHECK_FALSE(glass.materials[0].medium.has_value());
  CHECK(contains(glass.materials[0].medium_reason, "thin-walled"));
}

TEST_CASE("multi-scatter colours: the drafts' formula at its ends") {
  CHECK(albedo_from_multiscatter(0, 0) == Approx(0).margin(1e-4));
  CHECK(albedo_from_multiscatter(1, 0) == Approx(1));
  CHECK(albedo_from_multiscatter(1, 0.8) == Approx(1));
  CHECK(albedo_from_multiscatter(0.5, 0.5) > albedo_from_multiscatter(0.5, 0));
  CHECK(albedo_from_multiscatter(-3, 0) == Approx(0).margin(1e-4));
}

TEST_CASE("lights and environments of a scene file") {
  SceneFolder folder;
  Image sky(4, 2, {"R", "G", "B"});
  sky.set_rgb(0, 1, 0, Rgb(8));
  write_exr(folder.folder_ / "sky.exr", sky);
  const json lights{{{"type", "point"}, {"position", {1, 2, 3}}, {"intensity", 5}},
                    {{"type", "spot"},
                     {"position", {0, 3, 0}},
                     {"target", {0, 0, 0}},
                     {"intensity", {1, 2, 3}},
                     {"inner_cone", 10},
                     {"outer_cone", 20}},
                    {{"type", "directional"}, {"direction", {0, -2, 0}}, {"irradiance", 2}},
                    {{"type", "disk"},
                     {"position", {0, 3, 0}},
                     {"direction", {0, -1, 0}},
                     {"radius", 0.5},
                     {"radiance", 9}},
                    {{"type", "patch"}, {"position", {0, 0, 0}}, {"radius", 0.1}, {"radiance", 1}}};
  json description = with("lights", lights);
  description["environment"] = {{"file", "sky.exr"}, {"strength", 0.5}, {"visible", false}};
  const Scene scene = folder.load(description).scene;
  REQUIRE(scene.lights.size() == 5);
  CHECK(std::get<SpotLight>(scene.lights[1]).direction == Vec3(0, -1, 0));
  CHECK(std::get<SpotLight>(scene.lights[1]).outer_cone == Approx(pi / 9));
  CHECK(std::get<DirectionalLight>(scene.lights[2]).direction == Vec3(0, -1, 0));
  CHECK(std::get<PatchLight>(scene.lights[4]).radius == 0.1);
  CHECK_FALSE(scene.environment_visible);
  CHECK(scene.environment->mean_radiance().r == Approx(0.5));
  const Scene plain = folder.load(with("environment", {{"radiance", {1, 2, 3}}})).scene;
  CHECK(plain.environment->radiance({0, 1, 0}) == Rgb(1, 2, 3));
  // Turned by 90 degrees counter-clockwise seen from above, +x becomes -z.
  const Scene turned =
      folder
          .load(with("environment",
                     {{"sky", {{"ambient", 0}, {"key", 1}, {"direction", {1, 0, 0}}}}, {"rotation", 90}}))
          .scene;
  CHECK(turned.environment->radiance({0, 0, -1}).r == Approx(1));
}

TEST_CASE("integrator options come out as text") {
  SceneFolder folder;
  const auto options =
      folder
          .load(with("integrator",
                     {{"spp", 64}, {"size", "64x48"}, {"hide_environment", true}, {"exposure", -0.5}}))
          .integrator;
  CHECK(options.at("spp") == "64");
  CHECK(options.at("size") == "64x48");
  CHECK(options.at("hide_environment") == "true");
  CHECK(options.at("exposure") == "-0.5");
}

TEST_CASE("scene file errors name the place and the mend") {
  SceneFolder folder;
  struct Case {
    json scene;
    const char* place;
    const char* detail;
  };
  const json here{0, 0, 0};
  const std::vector<Case> cases{
      {{{"version", 1}}, "model", "missing"},
      {{{"version", 2}, {"model", "model.gltf"}}, "version", "version 1"},
      {with("camra", json::object()), "camra", "did you mean 'camera'?"},
      {with("camera", {{"postion", here}}), "camera.position", "missing"},
      {with("camera", {{"position", here}, {"target", here}}), "camera.target", "no length"},
      {with("camera", {{"position", here}, {"target", {0, 0, -1}}, {"direction", {0, 0, -1}}}),
       "camera.target", "exclude"},
      {with("camera", {{"position", here}, {"target", {0, 0, -1}}, {"fov", 30}}), "camera.fov",
       "vertical_fov"},
      {with("camera", {{"position", here}, {"target", {0, 1, 0}}}), "camera.up", "parallel"},
      {with("camera", {{"position", {0, 0}}, {"target", here}}), "camera.position", "three numbers"},
      {with("camera", {{"position", {0, 0, 1}}, {"target", here}, {"vertical_fov", 200}}),
       "camera.vertical_fov", "between"},
      {with("camera", {{"node", "sid"}}), "camera.node", "did you mean 'side'?"},
      {with("lights", {{{"type", "sun"}}}), "lights[0]", "known are point, spot"},
      {with("lights", {{{"type", "spoot"}}}), "lights[0].type", "did you mean 'spot'?"},
      {with("lights", {{{"position", here}}}), "lights[0].type", "missing"},
      {with("lights", {{{"type", "point"}, {"position", here}}}), "lights[0].intensity", "missing"},
      {with("lights", {{{"type", "point"}, {"position", here}, {"intensity", -1}}}), "lights[0].intensity",
       "between"},
      {with("lights", {{{"type", "disk"},
                        {"position", here},
                        {"direction", {0, 1, 0}},
                        {"radius", 0},
                        {"radiance", 1}}}),
       "lights[0].radius", "between"},
      {with("lights", {{{"type", "point"}, {"position", here}, {"intensity", 1}, {"radius", 1}}}),
       "lights[0].radius", "not a known key"},
      {with("lights", json::object()), "lights", "must be an array"},
      {with("environment", {{"radiance", 1}, {"sky", json::object()}}), "environment", "exclude"},
      {with("environment", {{"file", "none.exr"}}), "none.exr", "read"},
      {with("environment", {{"sky", {{"direction", {0, 0, 0}}}}}), "environment.sky.direction", "no length"},
      {with("environment", {{"visible", "no"}}), "environment.visible", "true or false"},
      {with("materials", {{"wax", {{"g", 1.5}}}}), "materials.wax.g", "between -0.99 and 0.99"},
      {with("materials", {{"wax", {{"albedo", {0.5, 0.5, 1.5}}}}}), "materials.wax.albedo", "each channel"},
      {with("materials", {{"wax", {{"albedo", 0.5}, {"reflectance", 0.5}}}}), "materials.wax.reflectance",
       "exclude"},
      {with("materials", {{"wax", {{"mean_free_path", "5 mm"}}}}), "materials.wax.mean_free_path",
       "not a length"},
      {with("materials", {{"wax", {{"mean_free_pth", 1}}}}), "materials.wax.mean_free_pth",
       "did you mean 'mean_free_path'?"},
      {with("materials", {{"wax", {{"albedo", "none.png"}}}}), "none.png", "read"},
      {with("integrator", {{"spp", {1, 2}}}), "integrator.spp", "must be a string"},
      {with("model", "nothing.glb"), "nothing.glb", "cannot be read"},
      {with("model", 5), "model", "must be a string"},
  };
  for (const Case& c : cases) {
    const std::string message = folder.error(c.scene);
    INFO(c.scene.dump() << "\n" << message);
    CHECK(contains(message, c.place));
    CHECK(contains(message, c.detail));
    CHECK_FALSE(contains(message, "\n"));
  }
}

TEST_CASE("JSON that does not parse is refused with line and column") {
  SceneFolder folder;
  const std::string message = folder.error_of_text("{\n  \"version\": 1,\n  \"model\": oops\n}");
  CHECK(contains(message, "scene.json"));
  CHECK(contains(message, "line 3, column 12"));
  CHECK(contains(folder.error_of_text(""), "line 1, column 1"));
  CHECK(contains(folder.error_of_text("[1, 2]"), "must be an object"));
  CHECK(contains(folder.error_of_text(std::string(100000, '[')), "nested"));
}

TEST_CASE("files of other kinds are refused") {
  const ScratchFolder folder;
  CHECK_THROWS_WITH(load_scene(folder / "model.obj", {}), Catch::Contains("neither a scene"));
  CHECK_THROWS_AS(load_scene(folder / "none.glb", {}), InputError);
  CHECK_THROWS_AS(load_scene(folder / "none.json", {}), InputError);
}

TEST_CASE("lengths of the command line") {
  CHECK(parse_length("0.01").value == Rgb(0.01));
  CHECK_FALSE(parse_length("0.01").relative);
  CHECK(parse_length("1,2,3").value == Rgb(1, 2, 3));
  CHECK(parse_length("0.5%").relative);
  CHECK(parse_length("0.5%").value.r == Approx(0.005));
  for (const char* bad : {"", "x", "1,2", "1,2,3,4", "-1", "0", "nan", "inf", "1,,2", "%", "5mm"}) {
    INFO(bad);
    CHECK_THROWS_AS(parse_length(bad), InputError);
  }
}

TEST_CASE("textured albedo: texels are inverted one by one, transparent masks reach every ray") {
  const ScratchFolder folder;
  set_quiet(true);
  TinyGltfFile file;
  file.add_square()["material"] = 0;
  Pixels8 picture(2, 1, 4);
  const std::array<uint8_t, 8> bytes{188, 188, 188, 255, 100, 100, 100, 0};
  std::copy(bytes.begin(), bytes.end(), picture.bytes.begin());
  const int texture = file.add_texture(encode_png(picture));
  file.root["textures"][0]["sampler"] = 0;
  file.root["samplers"] = {{{"magFilter", 9728}, {"wrapS", 33071}}};
  file.root["materials"] = {{{"alphaMode", "MASK"},
                             {"pbrMetallicRoughness",
                              {{"baseColorTexture", {{"index", texture}}},
                               {"metallicFactor", 0},
                               {"baseColorFactor", {0.5, 1, 1, 1}}}}}};
  const Scene scene = load_scene(file.write(folder), {}).scene;
  set_quiet(false);
  const auto albedo_at = [&](double x) {
    const SceneObject& object = scene.objects.at(0);
    Ray ray;
    ray.origin = {x, 0.3, 1};
    ray.direction = {0, 0, -1};
    // The second half of the square is cut out by its alpha.
    const auto hit = scene.rays.nearest(ray);
    CHECK(hit.has_value() == (x < 0.5));
    CHECK(scene.rays.occluded(ray) == (x < 0.5));
    return object.albedo->at(
        object.mesh.surface_point(hit ? hit->triangle : 0, hit ? hit->barycentric : Vec2(0)));
  };
  const double linear = std::pow((188 / 255.0 + 0.055) / 1.055, 2.4);
  const Rgb albedo = albedo_at(0.2);
  CHECK(albedo.r == Approx(baseline_profile().albedo_from_reflectance(0.5 * linear)).epsilon(1e-4));
  CHECK(albedo.g == Approx(baseline_profile().albedo_from_reflectance(linear)).epsilon(1e-4));
  albedo_at(0.8);
}

TEST_CASE("vertex colours without texture coordinates make the albedo") {
  const ScratchFolder folder;
  set_quiet(true);
  TinyGltfFile file;
  const int positions = file.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const int colours =
      file.add_accessor<float>({0.2f, 0.4f, 0.8f, 0.2f, 0.4f, 0.8f, 0.2f, 0.4f, 0.8f}, "VEC3");
  file.add_mesh({{"POSITION", positions}, {"COLOR_0", colours}});
  const Scene scene = load_scene(file.write(folder), {}).scene;
  set_quiet(false);
  const Rgb albedo = scene.objects.at(0).albedo->at({});
  CHECK(albedo.r == Approx(baseline_profile().albedo_from_reflectance(0.2)).epsilon(1e-5));
  CHECK(albedo.b == Approx(baseline_profile().albedo_from_reflectance(0.8)).epsilon(1e-5));
}
