#include "study/planar_scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/progress.h"
#include "image/image_decode.h"
#include "optics/profile_store.h"
#include "scene/json_reader.h"
#include "study/scene_sets.h"
#include "texture/texel_array.h"

namespace alabaster {

namespace fs = std::filesystem;

const ProfileTable& profile_for(const PlanarScene& scene) {
  return *profile_for(scene.medium.g, scene.medium.eta);  // the store keeps it
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Reflectances become albedos texel by texel; returns how many had to be clamped.
int invert(TexelArray& texels, const ProfileTable& profile) {
  int clamped = 0;
  for (Vec4f& texel : texels.texels)
    for (int c = 0; c < 3; ++c) {
      const double wanted = static_cast<double>(texel[c]);
      if (wanted > max_reflectance) ++clamped;
      texel[c] =
          static_cast<float>(profile.albedo_from_reflectance(std::clamp(wanted, 0.0, max_reflectance)));
    }
  return clamped;
}

class PlanarSceneReader {
 public:
  PlanarSceneReader(const fs::path& path, int resolution)
      : path_(path),
        file_(path.string()),
        resolution_(resolution),
        document_(parse_json(file_, read_text(path))) {}

  PlanarScene read() {
    JsonObject root(document_, file_, "");
    if (root.number("version", 1, 1).value_or(0) != 1) root.fail("version", "is missing; it must be 1");
    scene_.name = path_.stem().string();
    scene_.title = root.string("title").value_or(scene_.name);
    if (auto medium = root.object("medium")) read_medium(*medium);
    auto texture = root.object("texture");
    if (!texture) root.fail("texture", "is missing; it names the picture: {\"file\": ..., \"width\": ...}");
    read_texture(*texture);
    if (auto light = root.object("light")) read_light(*light);
    set_resolution(resolution_);
    if (auto view = root.object("view")) read_view(*view);
    root.finish();
    check(scene_);
    return scene_;
  }

 private:
  void read_medium(JsonObject medium) {
    scene_.medium.g = medium.number("g", -0.99, 0.99).value_or(0.3);
    scene_.medium.eta = medium.number("eta", 1, 4).value_or(1.5);
    medium.finish();
  }

  void read_texture(JsonObject texture) {
    const auto file = texture.string("file");
    if (!file) texture.fail("file", "is missing; it names the picture");
    const std::string meaning = texture.string("meaning").value_or("reflectance");
    if (meaning != "albedo" && meaning != "reflectance")
      texture.fail("meaning", "is '" + meaning + "'; it must be \"albedo\" or \"reflectance\"");
    const bool reflectance = meaning == "reflectance";
    // A reflectance is a colour, an albedo is data.
    const std::string encoding = texture.string("encoding").value_or(reflectance ? "srgb" : "linear");
    if (encoding != "srgb" && encoding != "linear")
      texture.fail("encoding", "is '" + encoding + "'; it must be \"srgb\" or \"linear\"");
    TexelArray texels = make_texels(read_image(path_.parent_path() / *file),
                                    encoding == "srgb" ? Encoding::srgb : Encoding::linear);
    const double width = texture.number("width", 1e-6, 1e9).value_or(10);  // mean free paths
    scene_.tile = Vec2(width, width * texels.height / texels.width);
    if (reflectance) {
      const int clamped = invert(texels, profile_for(scene_));
      if (clamped > 0)
        warn(fmt::format("{}: {} values of reflectance above {} were clamped", file_, clamped,
                         max_reflectance));
    }
    scene_.albedo = std::make_shared<TexelArray>(std::move(texels));
    texture.finish();
  }

  void read_light(JsonObject light) {
    const std::string type = light.string("type").value_or("disk");
    if (type == "disk") {
      scene_.light.shape = PlanarLight::Shape::disk;
    } else if (type == "square") {
      scene_.light.shape = PlanarLight::Shape::square;
    } else if (type == "plane") {
      scene_.light.shape = PlanarLight::Shape::plane;
    } else {
      light.fail("type", "is '" + type + "'; it must be \"disk\", \"square\" or \"plane\"");
    }
    scene_.light.centre = Vec2(light.vector("position").value_or(Vec3(0)));
    scene_.light.radius = light.number("radius", 1e-6, 1e9).value_or(1);
    scene_.light.radiance = light.rgb("radiance", 0, infinity).value_or(Rgb(1));
    light.finish();
  }

  void read_view(JsonObject view) {
    scene_.view.centre = Vec2(view.vector("position").value_or(Vec3(0)));
    const double width = view.number("width", 1e-6, 1e9).value_or(10);
    scene_.view.size = Vec2(width, view.number("height", 1e-6, 1e9).value_or(width));
    const Vec3 direction = view.vector("direction").value_or(Vec3(0, 0, -1));
    if (!(direction.z < 0)) view.fail("direction", "must look down on the surface; its z must be negative");
    scene_.view.towards = glm::normalize(-direction);
    scene_.view.radiosity = view.boolean("radiosity").value_or(false);
    set_resolution(static_cast<int>(view.number("pixels", 1, 16384).value_or(resolution_)));
    view.finish();
  }

  // Pixels of the longer side; pixels are square.
  void set_resolution(int longer) {
    PlanarView& view = scene_.view;
    const double pixel = std::max(view.size.x, view.size.y) / longer;
    view.width = std::max(1, static_cast<int>(std::lround(view.size.x / pixel)));
    view.height = std::max(1, static_cast<int>(std::lround(view.size.y / pixel)));
  }

  fs::path path_;
  std::string file_;
  int resolution_;
  nlohmann::json document_;
  PlanarScene scene_;
};

void apply_view(PlanarScene& scene, const std::string& view) {
  scene.name += "@" + view;
  if (view == "radiosity") {
    scene.view.radiosity = true;
    scene.title += ", radiosity";
    return;
  }
  double degrees = 0;
  const char* end = view.data() + view.size();
  const auto [stop, error] = std::from_chars(view.data(), end, degrees);
  if (error != std::errc() || stop != end || !(degrees >= 0 && degrees < 90))
    throw InputError("scene '" + scene.name +
                     "': after @ stands an angle off the normal, 0 to 90 degrees, or radiosity");
  scene.view.towards = Vec3(std::sin(degrees * pi / 180), 0, std::cos(degrees * pi / 180));
  scene.title += fmt::format(", seen at {} degrees", view);
}

}  // namespace

PlanarScene load_planar_scene(const fs::path& path, int resolution) {
  return PlanarSceneReader(path, resolution).read();
}

std::vector<PlanarScene> planar_scenes(const std::vector<std::string>& names, int resolution) {
  std::vector<PlanarScene> scenes;
  const auto add = [&](PlanarScene scene, const std::string& view) {
    if (!view.empty()) apply_view(scene, view);
    const auto same = [&](const PlanarScene& s) { return s.name == scene.name; };
    if (std::none_of(scenes.begin(), scenes.end(), same)) scenes.push_back(std::move(scene));
  };
  for (const std::string& name : names) {
    const std::size_t at = name.rfind('@');
    const std::string base = name.substr(0, at), view = at == std::string::npos ? "" : name.substr(at + 1);
    if (fs::path(base).extension() == ".json") {
      add(load_planar_scene(base, resolution), view);
    } else {
      for (const std::string& id : expand_scene_ids({base}))
        add(make_planar_study_scene(id, resolution), view);
    }
  }
  return scenes;
}

}  // namespace alabaster
