#include "study/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/cancellation.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "optics/fresnel.h"
#include "study/planar_scene_file.h"
#include "study/scene_sets.h"
#include "study/validation_output.h"
#include "study/validation_report.h"

namespace alabaster {

Quality quality_from_name(const std::string& name) {
  if (name == "quick") return Quality::quick;
  if (name == "full") return Quality::full;
  throw InputError("quality '" + name + "' is not known; use quick or full");
}

ValidationBudget budget(Quality quality) {
  ValidationBudget b;
  if (quality == Quality::full) {
    b.resolution = 200;
    b.reference_noise = 0.002;
    b.floor_noise = 0.003;
    b.max_paths = 10'000'000'000;
    b.spp = 512;
    b.sweep_spp = 256;
    b.footprint_paths = 4'000'000;
    b.map_paths = 40'000'000;
  }
  return b;
}

MeshBudget mesh_budget(Quality quality) {
  if (quality == Quality::full) return {256, 0.02, 1u << 15, 1024};
  return {};
}

const std::vector<double>& aggregate_widths() {
  static const std::vector<double> widths{0, 0.25, 0.5, 0.75, 1, 1.5, 2, 3};
  return widths;
}

namespace {

MethodResult measure(const PlanarScene& scene, const PlanarMethod& method, const ProfileTable& profile,
                     const Image& reference, uint32_t spp, uint64_t seed) {
  MethodResult result;
  result.model = method.name;
  result.render = render_planar(scene, method, profile, spp, seed);
  result.errors = compare_images(result.render.image, reference);
  return result;
}

}  // namespace

SceneResult measure_scene(const PlanarScene& scene, const std::vector<PlanarMethod>& methods,
                          const ProfileTable& profile, const ValidationBudget& budget, bool sweep,
                          uint64_t seed, ReferenceStore* store) {
  const auto reference = [&](const PlanarScene& lit, double noise, double known, uint64_t its_seed) {
    return store != nullptr ? store->get(lit, noise, known, budget.max_paths, its_seed)
                            : render_planar_reference(lit, noise, known, budget.max_paths, its_seed);
  };
  SceneResult result;
  result.scene = scene;
  result.reference = reference(scene, budget.reference_noise, budget.reference_known, seed);
  const Image& truth = result.reference.image;
  for (const PlanarMethod& method : methods)
    result.methods.push_back(measure(scene, method, profile, truth, budget.spp, seed + 1));
  if (sweep)
    for (const double width : aggregate_widths())
      result.sweep.push_back(measure(scene, parse_planar_method(fmt::format("aggregate:{}", width)), profile,
                                     truth, budget.sweep_spp, seed + 2));
  result.constant_albedo = mean_albedo(*scene.albedo);
  const PlanarScene constant = with_constant_albedo(scene, result.constant_albedo);
  const TimedImage floor = reference(constant, budget.floor_noise, 0, seed + 3);
  result.floor =
      measure(constant, parse_planar_method("homogeneous"), profile, floor.image, budget.spp, seed + 4);
  return result;
}

KernelMap measure_kernel(const PlanarScene& scene, Vec2 exit, const std::vector<PlanarMethod>& methods,
                         const ProfileTable& profile, const ValidationBudget& budget, uint64_t seed) {
  KernelMap map;
  map.scene = scene.name;
  // The centre of a pixel, so that the reference's light is one pixel.
  map.exit = scene.view.point(glm::floor(scene.view.pixel(exit)) + 0.5);
  // Both ends average over T(cos) / (pi c), so the true S is reciprocal: light on the exit's pixel, seen as
  // radiosity everywhere, is S from everywhere to the exit: radiosity / pi = c L S x area.
  PlanarScene lit = scene;
  lit.light.shape = PlanarLight::Shape::square;
  lit.light.centre = map.exit;
  lit.light.radius = 0.5 * scene.view.size.x / scene.view.width;
  lit.light.radiance = Rgb(1 / (diffuse_transmittance(scene.medium.eta) * lit.light.area()));
  lit.view.radiosity = true;
  map.maps.emplace_back("reference", render_planar_reference(lit, 1e-3, 0, budget.map_paths, seed).image);
  for (const PlanarMethod& method : methods) {
    const PlanarModel model(scene, method.model, profile, method.options);
    const BssrdfPoint at_exit = model.point(map.exit);
    Image image(scene.view.width, scene.view.height, {"R", "G", "B"});
    for (int y = 0; y < scene.view.height; ++y)
      for (int x = 0; x < scene.view.width; ++x) {
        const Vec2 entry = scene.view.point(Vec2(x, y) + 0.5);
        if (glm::distance(entry, map.exit) < 1e-9 * scene.view.size.x) continue;  // S is not finite there
        image.set_rgb(0, x, y, model.bssrdf().evaluate(model.point(entry), at_exit));
      }
    map.maps.emplace_back(method.name, std::move(image));
  }
  return map;
}

namespace {

const std::vector<std::string> standard_models{"homogeneous",   "factorized",          "aggregate",
                                               "composite",     "composite:symmetric", "composite:order1",
                                               "composite:view"};
const std::vector<std::string> rival_models{"homogeneous", "factorized", "aggregate", "composite"};

std::vector<PlanarMethod> parse_all(const std::vector<std::string>& names) {
  std::vector<PlanarMethod> methods;
  for (const std::string& name : names) methods.push_back(parse_planar_method(name));
  return methods;
}

std::vector<FootprintOptions> footprint_plan(const ValidationBudget& budget, uint64_t seed) {
  FootprintOptions unweighted;
  unweighted.paths = budget.footprint_paths;
  unweighted.seed = seed;
  std::vector<FootprintOptions> plan;
  for (const int max_order : {10, 100, 1000}) {
    plan.push_back(unweighted);
    plan.back().max_order = max_order;
  }
  for (const double albedo : {0.5, 0.9}) {
    plan.push_back(unweighted);
    plan.back().albedo = albedo;
    plan.back().max_order = 300;
  }
  return plan;
}

/// Exit points of the kernel maps: where textures differ, m.
const std::vector<std::pair<std::string, Vec2>>& kernel_points() {
  static const std::vector<std::pair<std::string, Vec2>> points{
      {"stripes1", {0.25, 0}}, {"stripes1", {0.75, 0}}, {"floral", {0.3, 0.4}}, {"logo", {1.2, 0.6}}};
  return points;
}

void report_row(const SceneResult& result) {
  std::string line = fmt::format("{}: floor {:.3f}", result.scene.name, result.floor.errors.rmse_over_rms);
  for (const MethodResult& m : result.methods)
    line += fmt::format(", {} {:.3f}", m.model, m.errors.rmse_over_rms);
  say(line);
}

void report_row(const MeshSceneResult& result) {
  if (result.methods.empty()) return;
  std::string line = fmt::format("{}: reference {:.0f} CPU s, noise {:.3f}", result.name,
                                 result.reference.cpu_seconds, noise_of(result.reference.image));
  for (const MeshMethodResult& m : result.methods)
    line += fmt::format(", {} {:.3f} (shape {:.3f})", m.model, *m.errors.bias, *m.shape.bias);
  say(line);
}

class ValidationRun {
 public:
  ValidationRun(const ValidationOptions& options)
      : options_(options),
        budget_(budget(options.quality)),
        mesh_budget_(options.mesh_budget.value_or(mesh_budget(options.quality))),
        store_(options.cache.empty() ? default_reference_folder() : options.cache) {
    std::vector<std::string> flat, meshes;
    for (const std::string& name : options.scenes) (is_mesh_scene_name(name) ? meshes : flat).push_back(name);
    if (!flat.empty()) scenes_ = planar_scenes(flat, budget_.resolution);
    if (!meshes.empty()) meshes_ = expand_mesh_scenes(meshes);
    choose_methods();
  }

  ValidationResult run() {
    const double wall = wall_seconds(), cpu = cpu_seconds();
    measure_flat_scenes();
    measure_meshes();
    result_.cancelled = cancellation_requested();
    result_.seconds = wall_seconds() - wall;
    result_.cpu_seconds = cpu_seconds() - cpu;
    return std::move(result_);
  }

 private:
  void choose_methods() {
    // Someone who asks for certain models wants those alone.
    if (options_.models.empty()) {
      methods_ = parse_all(standard_models);
      mesh_methods_ = standard_mesh_methods();
      return;
    }
    if (!scenes_.empty()) methods_ = parse_all(options_.models);
    if (meshes_.empty()) return;
    for (const std::string& name : options_.models) mesh_methods_.push_back(parse_mesh_method(name));
  }

  void measure_flat_scenes() {
    for (const PlanarScene& scene : scenes_) {
      if (cancellation_requested()) return;
      progress_.update(fraction_done(), scene.name);
      const bool sweep = options_.models.empty();
      SceneResult measured =
          measure_scene(scene, methods_, profile_for(scene), budget_, sweep, options_.seed, &store_);
      if (cancellation_requested()) return;  // its images are unfinished
      result_.scenes.push_back(std::move(measured));
      report_row(result_.scenes.back());
    }
    if (options_.models.empty() && !scenes_.empty()) measure_kernels_and_footprints();
  }

  void measure_meshes() {
    for (const std::string& scene : meshes_) {
      if (cancellation_requested()) return;
      progress_.update(fraction_done(), scene);
      MeshSceneResult measured = measure_mesh(scene, mesh_methods_, mesh_budget_, store_, options_.seed);
      if (cancellation_requested()) return;
      result_.meshes.push_back(std::move(measured));
      report_row(result_.meshes.back());
    }
  }

  void measure_kernels_and_footprints() {
    const std::vector<PlanarMethod> rivals = parse_all(rival_models);
    for (const auto& [name, exit] : kernel_points())
      for (const PlanarScene& scene : scenes_)
        if (scene.name == name && !cancellation_requested())
          result_.maps.push_back(
              measure_kernel(scene, exit, rivals, profile_for(scene), budget_, options_.seed));
    for (const FootprintOptions& plan : footprint_plan(budget_, options_.seed)) {
      if (cancellation_requested()) break;
      result_.footprint_options.push_back(plan);
      result_.footprints.push_back(measure_footprints(plan));
    }
    measure_speed_and_energy();
  }

  void measure_speed_and_energy() {
    if (cancellation_requested()) return;
    const PlanarScene& first = scenes_.front();
    result_.speed = measure_planar_speed(first, profile_for(first), options_.seed);
    for (const PlanarScene& scene : scenes_)
      for (const char* model : {"composite", "composite:order1"})
        result_.excess.emplace_back(
            scene.name + ", " + model,
            energy_excess(PlanarModel(scene, model, profile_for(scene)), profile_for(scene), options_.seed));
  }

  double fraction_done() const {
    return static_cast<double>(result_.scenes.size() + result_.meshes.size()) /
           (1.1 * static_cast<double>(scenes_.size() + meshes_.size()));
  }

  const ValidationOptions& options_;
  ValidationBudget budget_;
  MeshBudget mesh_budget_;
  ReferenceStore store_;
  std::vector<PlanarScene> scenes_;
  std::vector<PlanarMethod> methods_;
  std::vector<std::string> meshes_;
  std::vector<MeshMethod> mesh_methods_;
  ValidationResult result_;
  Progress progress_{"validating"};
};

}  // namespace

ValidationResult validate(const ValidationOptions& options) {
  ValidationResult result = ValidationRun(options).run();
  write_validation(result, options);
  validation_page(result, options).write(options.output / "report.html");
  return result;
}

}  // namespace alabaster
