#include "study/scene_sets.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/error.h"
#include "texture/patterns.h"

namespace alabaster {

namespace {

constexpr const char* bleeding = "colour_bleeding_x";

[[noreturn]] void refuse(const std::string& id, const std::string& what) {
  std::string known;
  for (const StudyScene& scene : study_scenes()) known += (known.empty() ? "" : ", ") + scene.id;
  throw InputError(
      fmt::format("scene '{}': {}; known are {}, and the sets planar, planar-more, mesh", id, what, known));
}

}  // namespace

const std::vector<StudyScene>& study_scenes() {
  static const std::vector<StudyScene> scenes{
      {"stripes1", "Stripes, one mean free path per period", "planar"},
      {"stripes2", "Stripes, a quarter of a mean free path per period", "planar"},
      {"floral", "Ornament at several scales", "planar"},
      {"escher", "Interlocking figures", "planar"},
      {"cork", "Cork, natural and coloured", "planar"},
      {"logo", "Plain shapes in strong colours", "planar"},
      {"colour_bleeding_x0.25", "Colour bleeding, a quarter of the density", "planar"},
      {"colour_bleeding_x0.5", "Colour bleeding, half the density", "planar"},
      {"colour_bleeding_x1", "Colour bleeding", "planar"},
      {"colour_bleeding_x2", "Colour bleeding, twice the density", "planar"},
      {"colour_bleeding_x4", "Colour bleeding, four times the density", "planar"},
      {"dots", "Round dots, one mean free path apart", "planar-more"},
      {"checker", "Squares of one mean free path", "planar-more"},
      {"constant", "One albedo everywhere", "planar-more"},
      {"sphere_1", "Sphere of radius 1 mean free path", "mesh"},
      {"sphere_3", "Sphere of radius 3 mean free paths", "mesh"},
      {"sphere_10", "Sphere of radius 10 mean free paths", "mesh"},
      {"sphere_30", "Sphere of radius 30 mean free paths", "mesh"},
      {"cylinder_3", "Cylinder of radius 3 mean free paths", "mesh"},
      {"torus", "Torus, tube radius 3 and ring radius 9 mean free paths", "mesh"},
      {"ellipsoid_3", "Ellipsoid 1:1:3, shortest semi-axis 3 mean free paths", "mesh"},
      {"blob", "Bumpy blob of radius 10 mean free paths", "mesh"},
      {"fold", "Folded sheet, 2 mean free paths thick, half a mean free path between its layers", "mesh"},
      {"slab_1", "Slab, 1 mean free path thick", "mesh"},
      {"slab_2", "Slab, 2 mean free paths thick", "mesh"},
      {"slab_5", "Slab, 5 mean free paths thick", "mesh"}};
  return scenes;
}

std::vector<std::string> expand_scene_ids(const std::vector<std::string>& ids_and_sets) {
  std::set<std::string> wanted;
  for (const std::string& name : ids_and_sets) {
    bool found = false;
    for (const StudyScene& scene : study_scenes())
      if (scene.id == name || scene.set == name) {
        wanted.insert(scene.id);
        found = true;
      }
    if (!found) refuse(name, "not known");
  }
  std::vector<std::string> ids;
  for (const StudyScene& scene : study_scenes())
    if (wanted.count(scene.id)) ids.push_back(scene.id);
  return ids;
}

PlanarScene make_planar_study_scene(const std::string& id, int pixels) {
  const auto& scenes = study_scenes();
  const auto entry =
      std::find_if(scenes.begin(), scenes.end(), [&](const StudyScene& scene) { return scene.id == id; });
  if (entry == scenes.end()) refuse(id, "not known");
  if (entry->set == "mesh") refuse(id, "is a mesh; only flat scenes can be used here");

  PlanarScene scene;
  scene.name = id;
  scene.title = entry->title;
  scene.view.width = scene.view.height = pixels;
  std::string pattern = id;
  if (id.rfind(bleeding, 0) == 0) {
    pattern = "logo";
    scene.light.radius = 4;
    const double density = std::stod(id.substr(std::string(bleeding).size()));
    scene.medium.mean_free_path = Rgb(1 / density);
  }
  scene.albedo = std::make_shared<TexelArray>(make_pattern(pattern));
  return scene;
}

}  // namespace alabaster
