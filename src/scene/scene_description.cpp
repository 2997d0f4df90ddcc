#include "scene/scene_description.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "scene/json_reader.h"

namespace alabaster {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double largest = 1e12;    // of anything that must be finite
constexpr double smallest = 1e-12;  // of anything that must be positive

class DescriptionReader {
 public:
  explicit DescriptionReader(const fs::path& path)
      : file_(path.string()), folder_(path.parent_path()), root_(parse_json(file_, read_text(path))) {}

  SceneDescription read() {
    JsonObject root(root_, file_, "");
    SceneDescription scene;
    if (const auto version = root.number("version", 1, infinity); version && *version != 1)
      root.fail("version", fmt::format("is {}; this program reads version 1", *version));
    const auto model = root.string("model");
    if (!model) root.fail("model", "is missing; name a .glb or .gltf file, relative to this one");
    scene.model = folder_ / *model;
    if (auto camera = root.object("camera")) read_camera(*camera, scene);
    for (const auto& [value, place] : root.array("lights")) {
      JsonObject light(*value, file_, place);
      scene.lights.push_back(read_light(light));
    }
    if (auto environment = root.object("environment")) read_environment(*environment, scene);
    if (auto materials = root.object("materials"))
      for (const auto& [name, value] : materials->members())
        scene.materials[name] = read_material(JsonObject(*value, file_, materials->place_of(name)));
    if (auto integrator = root.object("integrator")) read_integrator(*integrator, scene);
    root.finish();
    return scene;
  }

 private:
  static Vec3 unit(JsonObject& object, const char* key, const Vec3& v) {
    const double length = glm::length(v);
    if (!(length > 0) || !std::isfinite(length)) object.fail(key, "has no length; give a direction");
    return v / length;
  }

  static Vec3 required_vector(JsonObject& object, const char* key, const char* what) {
    const auto value = object.vector(key);
    if (!value) object.fail(key, std::string("is missing; give ") + what + " as [x, y, z]");
    return *value;
  }

  /// "direction" or "target"; nothing when neither is there.
  static std::optional<Vec3> direction_or_target(JsonObject& object, const Vec3& position) {
    const auto direction = object.vector("direction");
    const auto target = object.vector("target");
    if (direction && target) object.fail("target", "and direction exclude each other; keep one");
    if (direction) return unit(object, "direction", *direction);
    if (target) return unit(object, "target", *target - position);
    return std::nullopt;
  }

  void read_camera(JsonObject& object, SceneDescription& scene) {
    if (const auto node = object.string("node")) {
      scene.camera_node = *node;
      for (const char* key : {"position", "target", "direction", "up", "vertical_fov", "orthographic_height"})
        if (object.has(key)) object.fail(key, "has no effect beside node, which names a camera of the model");
      object.finish();
      return;
    }
    Camera camera;
    camera.name = "scene file";
    camera.position = required_vector(object, "position", "the eye");
    const auto direction = direction_or_target(object, camera.position);
    if (!direction) object.fail("target", "is missing; give target or direction as [x, y, z]");
    camera.direction = *direction;
    if (const auto up = object.vector("up")) camera.up = unit(object, "up", *up);
    if (glm::length(glm::cross(camera.direction, camera.up)) < 1e-6)
      object.fail("up", "is parallel to the viewing direction; choose another");
    camera.vertical_fov = object.number("vertical_fov", 0.001, 179).value_or(camera.vertical_fov);
    camera.orthographic_height = object.number("orthographic_height", smallest, largest).value_or(0);
    object.finish();
    scene.camera = camera;
  }

  Rgb required_rgb(JsonObject& object, const char* key) const {
    const auto value = object.rgb(key, 0, largest);
    if (!value) object.fail(key, "is missing; give a number or [r, g, b]");
    return *value;
  }

  static double required_number(JsonObject& object, const char* key, double low, double high,
                                const char* unit) {
    const auto value = object.number(key, low, high);
    if (!value) object.fail(key, std::string("is missing; give a number in ") + unit);
    return *value;
  }

  Light read_light(JsonObject& object) {
    const std::vector<std::string> types{"point", "spot", "directional", "disk", "patch"};
    const auto type = object.string("type");
    if (!type) object.fail("type", "is missing; it is one of point, spot, directional, disk, patch");
    Light light = read_light(object, *type, types);
    object.finish();
    return light;
  }

  Light read_light(JsonObject& object, const std::string& type, const std::vector<std::string>& types) {
    if (type == "directional") {
      const Vec3 direction =
          unit(object, "direction", required_vector(object, "direction", "where light travels"));
      return DirectionalLight{direction, required_rgb(object, "irradiance")};
    }
    if (std::find(types.begin(), types.end(), type) == types.end())
      object.fail("type", "'" + type + "' is not a light" + suggestion(type, types));
    const Vec3 position = required_vector(object, "position", "a place");
    if (type == "point") return PointLight{position, required_rgb(object, "intensity")};
    if (type == "patch")
      return PatchLight{position, required_number(object, "radius", smallest, largest, "metres"),
                        required_rgb(object, "radiance")};
    const auto direction = direction_or_target(object, position);
    if (!direction) object.fail("direction", "is missing; give direction or target as [x, y, z]");
    if (type == "disk")
      return DiskLight{position, *direction, required_number(object, "radius", smallest, largest, "metres"),
                       required_rgb(object, "radiance")};
    const double outer = object.number("outer_cone", 0.01, 90).value_or(45);
    const double inner = object.number("inner_cone", 0, outer).value_or(0);
    return SpotLight{position, *direction, required_rgb(object, "intensity"), inner * pi / 180,
                     outer * pi / 180};
  }

  void read_environment(JsonObject& object, SceneDescription& scene) {
    const auto file = object.string("file");
    const auto radiance = object.rgb("radiance", 0, largest);
    auto sky = object.object("sky");
    if ((file ? 1 : 0) + (radiance ? 1 : 0) + (sky ? 1 : 0) > 1)
      object.fail("file, radiance and sky exclude each other; keep one");
    const double rotation = object.number("rotation", -36000, 36000).value_or(0) * pi / 180;
    const auto strength = object.rgb("strength", 0, largest);
    if (strength && !file) object.fail("strength", "scales a file; here change the radiance itself");
    scene.environment_visible = object.boolean("visible").value_or(true);
    object.finish();
    if (file) {
      scene.environment = load_latlong_environment(folder_ / *file, rotation, strength.value_or(Rgb(1)));
    } else if (radiance) {
      scene.environment = make_constant_environment(*radiance);
    } else {
      SkyParameters parameters;
      if (sky) read_sky(*sky, parameters);
      const double c = std::cos(rotation), s = std::sin(rotation);
      const Vec3 d = parameters.direction;
      parameters.direction = {c * d.x + s * d.z, d.y, c * d.z - s * d.x};
      scene.environment = make_sky_environment(parameters);
    }
  }

  void read_sky(JsonObject& object, SkyParameters& sky) {
    sky.ambient = object.rgb("ambient", 0, largest).value_or(sky.ambient);
    sky.key = object.rgb("key", 0, largest).value_or(sky.key);
    sky.exponent = object.number("exponent", 0, 1e6).value_or(sky.exponent);
    if (const auto direction = object.vector("direction"))
      sky.direction = unit(object, "direction", *direction);
    object.finish();
  }

  /// A colour, or the name of a picture.
  std::optional<MaterialOverride::Colour> colour_or_picture(JsonObject& object, const char* key) {
    if (object.is_string(key)) return MaterialOverride::Colour(folder_ / *object.string(key));
    if (const auto value = object.rgb(key, 0, 1)) return MaterialOverride::Colour(*value);
    return std::nullopt;
  }

  MaterialOverride read_material(JsonObject object) {
    MaterialOverride rule;
    rule.subsurface = object.boolean("subsurface");
    rule.albedo = colour_or_picture(object, "albedo");
    rule.reflectance = colour_or_picture(object, "reflectance");
    if (rule.albedo && rule.reflectance)
      object.fail("reflectance", "and albedo exclude each other; keep one");
    if (object.is_string("mean_free_path")) {
      try {
        rule.mean_free_path = parse_length(*object.string("mean_free_path"));
      } catch (const InputError& error) {
        object.fail("mean_free_path", error.what());
      }
    } else if (const auto value = object.rgb("mean_free_path", smallest, largest)) {
      rule.mean_free_path = LengthSpecification{*value, false};
    }
    if (object.is_string("density"))
      rule.density_map = folder_ / *object.string("density");
    else
      rule.density = object.number("density", smallest, largest);
    rule.g = object.number("g", -0.99, 0.99);
    rule.eta = object.number("eta", 1, 4);
    rule.roughness = object.number("roughness", 0, 1);
    object.finish();
    return rule;
  }

  void read_integrator(JsonObject& object, SceneDescription& scene) {
    for (const auto& [key, value] : object.members()) {
      if (value->is_string())
        scene.integrator[key] = value->get<std::string>();
      else if (value->is_number() || value->is_boolean())
        scene.integrator[key] = value->dump();
      else
        object.fail(key, "must be a string, a number, or true or false");
    }
  }

  std::string file_;
  fs::path folder_;
  json root_;
};

}  // namespace

SceneDescription read_scene_description(const fs::path& path) {
  return DescriptionReader(path).read();
}

}  // namespace alabaster
