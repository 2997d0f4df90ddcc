#include "study/speed_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "core/cancellation.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/rng.h"
#include "integrators/planar_volume.h"
#include "study/planar_scene_file.h"
#include "study/speed_accuracy_output.h"

namespace alabaster {

ChartBudget chart_budget(Quality quality) {
  ChartBudget result{budget(quality), mesh_budget(quality)};
  if (quality == Quality::full) result.spp = {1, 4, 16, 64, 256, 1024, 4096};
  return result;
}

void mark_front(std::vector<ChartRow>& rows) {
  for (ChartRow& row : rows)
    row.on_front = std::none_of(rows.begin(), rows.end(), [&](const ChartRow& other) {
      const bool no_worse = other.cpu_seconds <= row.cpu_seconds && other.rmse_over_rms <= row.rmse_over_rms;
      return no_worse && (other.cpu_seconds < row.cpu_seconds || other.rmse_over_rms < row.rmse_over_rms);
    });
}

namespace {

const std::vector<std::string> standard_scenes{"stripes1", "floral", "sphere_3", "sphere_10",
                                               "torus",    "blob",   "fold",     "slab_2"};

/// A method made ready for one scene.
struct ReadyMethod {
  std::string name;
  std::function<TimedImage(uint32_t spp, uint64_t seed)> render;
};

/// A scene with its reference and the methods to be measured on it. Closures refer to what `owner` holds.
struct ReadyScene {
  std::string name, title;
  TimedImage reference;
  std::vector<ReadyMethod> methods;
  std::shared_ptr<const void> owner;
};

/// Measurements of one method and sample count, averaged: times and squared errors.
class Average {
 public:
  void add(const TimedImage& render, const Image& reference) {
    const Metrics m = compare_images(render.image, reference);
    ++count_;
    seconds_ += render.seconds;
    cpu_seconds_ += render.cpu_seconds;
    square_ += m.rmse_over_rms * m.rmse_over_rms;
    noise_ += *m.noise * *m.noise;
    bias_ += *m.bias * std::abs(*m.bias);
  }
  void store(double reference_noise, ChartRow& row) const {
    row.seconds = seconds_ / count_;
    row.cpu_seconds = cpu_seconds_ / count_;
    row.rmse_over_rms = std::sqrt(square_ / count_);
    row.noise = std::sqrt(noise_ / count_);
    row.bias = std::copysign(std::sqrt(std::abs(bias_ / count_)), bias_);
    row.error = std::sqrt(std::max(0.0, square_ / count_ - reference_noise * reference_noise));
  }

 private:
  double count_ = 0, seconds_ = 0, cpu_seconds_ = 0, square_ = 0, noise_ = 0, bias_ = 0;
};

/// How often to measure: few samples are soon taken, and say little.
uint32_t repeats(uint32_t spp) {
  return std::clamp(64 / spp, 1u, 8u);
}

ChartScene measure(const ReadyScene& scene, const std::vector<uint32_t>& counts, uint64_t seed) {
  ChartScene result{scene.name, scene.title, "", scene.reference, {}, {}};
  const double reference_noise = noise_of(scene.reference.image);
  for (const ReadyMethod& method : scene.methods) method.render(1, seed);  // wakes caches and tables
  for (const uint32_t spp : counts) {
    std::vector<Average> averages(scene.methods.size());
    result.images.assign(scene.methods.size(), {});
    for (uint32_t repeat = 0; repeat < repeats(spp); ++repeat)
      for (std::size_t i = 0; i < scene.methods.size(); ++i) {
        TimedImage render = scene.methods[i].render(spp, hash_combine(hash_combine(seed, spp), repeat));
        if (cancellation_requested()) return result;  // this round is not whole
        averages[i].add(render, scene.reference.image);
        result.images[i] = {scene.methods[i].name, std::move(render.image)};
      }
    for (std::size_t i = 0; i < scene.methods.size(); ++i) {
      ChartRow row{scene.name, scene.methods[i].name, spp};
      averages[i].store(reference_noise, row);
      result.rows.push_back(row);
    }
  }
  mark_front(result.rows);
  return result;
}

// ---- flat scenes

/// The flat laboratory's name of a method: composite+half-space+symmetric is composite:symmetric there. Empty
/// for methods that flat scenes do not have.
std::string planar_name(const MeshMethod& method) {
  return method.transport == Transport::bssrdf && method.basis == "half-space" ? method.model : "";
}

TimedImage render_planar_volume(const PlanarScene& scene, uint32_t spp, uint64_t seed) {
  PlanarVolumeOptions options;
  options.seed = seed;
  if (scene.light.shape == PlanarLight::Shape::plane) options.estimator = PlanarEstimator::from_camera;
  const double start = wall_seconds();
  PlanarVolume volume(scene, options);
  volume.run(uint64_t{spp} * static_cast<uint64_t>(scene.view.width) *
             static_cast<uint64_t>(scene.view.height));
  return {volume.develop(), wall_seconds() - start, volume.cpu_seconds(), volume.paths()};
}

ReadyScene ready(const PlanarScene& flat, const std::vector<MeshMethod>& methods,
                 const ValidationBudget& budget, ReferenceStore& store, uint64_t seed) {
  ReadyScene result{flat.name,
                    flat.title,
                    store.get(flat, budget.reference_noise, budget.reference_known, budget.max_paths, seed),
                    {},
                    {}};
  const auto scene = std::make_shared<PlanarScene>(flat);
  result.owner = scene;
  for (const MeshMethod& method : methods) {
    if (method.transport == Transport::volume)
      result.methods.push_back(
          {method.name, [scene](uint32_t spp, uint64_t s) { return render_planar_volume(*scene, spp, s); }});
    if (planar_name(method).empty()) continue;
    result.methods.push_back(
        {method.name, [scene, planar = parse_planar_method(planar_name(method))](uint32_t spp, uint64_t s) {
           return render_planar(*scene, planar, profile_for(*scene), spp, s);
         }});
  }
  return result;
}

// ---- meshes

std::optional<ReadyScene> ready(MeshScene mesh, const std::vector<MeshMethod>& methods,
                                const MeshBudget& budget, ReferenceStore& store, uint64_t seed) {
  const auto scene = std::make_shared<MeshScene>(std::move(mesh));
  auto reference = store.get(*scene, false, {budget.reference_noise, budget.max_spp, seed});
  if (!reference) return std::nullopt;
  ReadyScene result{scene->name, scene->title, std::move(*reference), {}, scene};
  for (const MeshMethod& method : methods) {
    const auto integrator = std::make_shared<SurfaceIntegrator>(scene->scene, method.apply(scene->options()));
    result.methods.push_back(
        {method.name, [integrator, label = scene->name + " " + method.name](uint32_t spp, uint64_t s) {
           return render_timed(*integrator, label, spp, s);
         }});
  }
  return result;
}

class ChartRun {
 public:
  explicit ChartRun(const ChartOptions& options)
      : options_(options),
        budget_(options.budget.value_or(chart_budget(options.quality))),
        store_(options.cache.empty() ? default_reference_folder() : options.cache) {
    std::vector<std::string> flat, meshes;
    for (const std::string& name : options.scenes.empty() ? standard_scenes : options.scenes)
      (is_mesh_scene_name(name) ? meshes : flat).push_back(name);
    if (!flat.empty()) flat_ = planar_scenes(flat, budget_.flat.resolution);
    if (!meshes.empty()) meshes_ = expand_mesh_scenes(meshes);
    for (const std::string& name : options.methods) methods_.push_back(parse_mesh_method(name));
    if (!methods_.empty()) return;
    methods_ = standard_mesh_methods();
    methods_.push_back(parse_mesh_method("volume"));
  }

  ChartResult run() {
    const double wall = wall_seconds(), cpu = cpu_seconds();
    for (const PlanarScene& scene : flat_)
      if (!cancellation_requested()) finish(ready(scene, methods_, budget_.flat, store_, options_.seed));
    for (const std::string& name : meshes_)
      if (!cancellation_requested()) measure_mesh_scene(name);
    result_.cancelled = cancellation_requested();
    result_.seconds = wall_seconds() - wall;
    result_.cpu_seconds = cpu_seconds() - cpu;
    return std::move(result_);
  }

 private:
  void measure_mesh_scene(const std::string& name) {
    MeshScene mesh = load_mesh_scene(name, budget_.mesh.resolution);
    const std::string obstacle = obstacle_to_reference(mesh);
    if (!obstacle.empty()) {
      warn(obstacle + " (left out)");
      result_.scenes.push_back({mesh.name, mesh.title, obstacle, {}, {}, {}});
      return;
    }
    if (const auto scene = ready(std::move(mesh), methods_, budget_.mesh, store_, options_.seed))
      finish(*scene);
  }

  void finish(const ReadyScene& scene) {
    if (cancellation_requested()) return;
    ChartScene measured = measure(scene, budget_.spp, options_.seed);
    if (cancellation_requested()) return;
    say(fmt::format("{}: {} rows, reference {:.0f} CPU s, noise {:.3f}", scene.name, measured.rows.size(),
                    scene.reference.cpu_seconds, noise_of(scene.reference.image)));
    result_.scenes.push_back(std::move(measured));
  }

  const ChartOptions& options_;
  ChartBudget budget_;
  ReferenceStore store_;
  std::vector<PlanarScene> flat_;
  std::vector<std::string> meshes_;
  std::vector<MeshMethod> methods_;
  ChartResult result_;
};

}  // namespace

ChartResult chart_speed_and_accuracy(const ChartOptions& options) {
  ChartResult result = ChartRun(options).run();
  write_chart_result(result, options);
  return result;
}

}  // namespace alabaster
