#include "cli/render_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>
#include <utility>

#include "cli/commands.h"
#include "core/atomic_file.h"
#include "core/cancellation.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "image/exr_file.h"
#include "image/png_file.h"
#include "integrators/surface.h"

namespace alabaster {

namespace {

namespace fs = std::filesystem;

constexpr const char* interrupted_early =
    "alabaster: interrupted before the first sample; no image was written\n";

// Outputs that cannot be written should be known before an hour of rendering.
void check_output(const fs::path& path, const char* extension) {
  if (path.extension() != extension)
    throw InputError(path.string(), fmt::format("the output's name must end in {}", extension));
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path.string(), "is a folder; name a file");
  if (error == std::errc::filename_too_long) throw InputError(path.string(), "the output's name is too long");
  require_folder(path.parent_path(), path);
}

Camera find_camera(const Scene& scene, const std::string& name) {
  if (name.empty()) return scene.cameras.front();
  std::string known;
  for (const Camera& camera : scene.cameras) {
    if (camera.name == name) return camera;
    known += (known.empty() ? "" : ", ") + (camera.name.empty() ? std::string("(unnamed)") : camera.name);
  }
  throw InputError(scene.name, fmt::format("camera '{}' is not in the scene; it has {}", name, known));
}

// The camera carried about the vertical line through the scene's centre, `turn` radians counter-clockwise
// from above.
Camera turned(Camera camera, const Scene& scene, double turn) {
  const Vec3 centre = scene.bounds.centre();
  const auto rotate = [&](const Vec3& v) {
    return Vec3(std::cos(turn) * v.x + std::sin(turn) * v.z, v.y,
                -std::sin(turn) * v.x + std::cos(turn) * v.z);
  };
  camera.position = centre + rotate(camera.position - centre);
  camera.direction = rotate(camera.direction);
  camera.up = rotate(camera.up);
  return camera;
}

fs::path numbered(const fs::path& path, int frame) {
  fs::path result = path;
  return result.replace_filename(
      fmt::format("{}.{:04d}{}", path.stem().string(), frame, path.extension().string()));
}

std::string now() {
  const std::time_t time = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&time));
  return text;
}

void write_outputs(const RenderJob& job, const RenderSettings& settings, const RenderResult& result,
                   const fs::path& output, const fs::path& png) {
  const Image image = result.film.develop();
  write_exr(output, image,
            {{"alabaster.version", program_version()},
             {"alabaster.input", job.input.string()},
             {"alabaster.options", job_fingerprint(job)},
             {"alabaster.seed", std::to_string(settings.seed)},
             {"alabaster.samples", std::to_string(result.samples)},
             {"alabaster.seconds", fmt::format("{:.3f}", result.seconds)},
             {"alabaster.cpu_seconds", fmt::format("{:.3f}", result.cpu_seconds)},
             {"alabaster.complete", result.cancelled ? "no" : "yes"},
             {"alabaster.date", now()}});
  if (!png.empty()) write_png(png, display_pixels(image, settings.exposure));
}

std::string samples_text(const RenderResult& result) {
  return result.fewest == result.most ? fmt::format("{} spp", result.most)
                                      : fmt::format("{} to {} spp", result.fewest, result.most);
}

void say_closing_line(const RenderResult& result, const fs::path& output) {
  say(fmt::format("{}: {}x{}, {}, {}, {:.3f} million samples per CPU second{}", output.string(),
                  result.film.width(), result.film.height(), samples_text(result),
                  format_duration(result.seconds),
                  1e-6 * static_cast<double>(result.samples) / std::max(1e-9, result.cpu_seconds),
                  result.cancelled ? " (stopped early)" : ""));
  if (result.rejected > 0)
    warn(fmt::format("{} samples were not finite and count as black: please report this scene",
                     result.rejected));
}

void say_angular_size(const Scene& scene, const RenderSettings& settings) {
  const auto sizeless = std::count_if(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
    return std::holds_alternative<PointLight>(light) || std::holds_alternative<SpotLight>(light) ||
           std::holds_alternative<DirectionalLight>(light);
  });
  const double degrees = settings.angular_size.value_or(settings.integrator == "surface" ? 0 : 1);
  if (sizeless > 0 && degrees > 0)
    say(fmt::format(
        "{}: its {} point, spot and directional light{} fill {:g} degree{}; change it with --angular-size",
        scene.name, sizeless, sizeless == 1 ? "" : "s", degrees, degrees == 1 ? "" : "s"));
}

SurfaceOptions surface_options(const RenderSettings& settings, const Scene& scene, const Camera& camera) {
  SurfaceOptions options;
  options.width = settings.width;
  options.height = settings.height;
  options.camera = camera;
  options.transport = settings.integrator == "volume" ? Transport::volume
                      : settings.integrator == "walk" ? Transport::walk
                                                      : Transport::bssrdf;
  options.model = settings.model;
  options.basis = settings.basis == "shape" ? Basis::shape : Basis::half_space;
  options.walk = settings.walk;
  options.placement = settings.placement;
  options.layer = settings.layer;
  if (settings.angular_size) options.angular_size = *settings.angular_size * pi / 180;
  options.depth = settings.depth;
  options.environment_visible = scene.environment_visible && !settings.load.hide_environment;
  return options;
}

RenderOptions render_options(const RenderSettings& settings, const std::string& label) {
  RenderOptions options;
  options.spp = settings.samples_per_pixel();
  options.sampler = settings.sampler;
  options.seed = settings.seed;
  options.crop = settings.crop;
  options.time_limit = settings.time;
  options.label = label;
  return options;
}

}  // namespace

std::string SceneCache::key(const fs::path& input, const LoadOptions& o) {
  std::error_code ignored;
  std::string text = fs::weakly_canonical(input, ignored).string();
  for (const std::string& name : o.subsurface) text += "|" + name;
  if (o.mean_free_path) {
    const Rgb& v = o.mean_free_path->value;
    text += fmt::format("|path {} {} {} {}", v.r, v.g, v.b, o.mean_free_path->relative);
  }
  if (o.g) text += fmt::format("|g {}", *o.g);
  if (o.eta) text += fmt::format("|eta {}", *o.eta);
  return text + "|map " + o.subsurface_map;
}

std::shared_ptr<const LoadedScene> SceneCache::get(const fs::path& input, const LoadOptions& options) {
  std::shared_ptr<const LoadedScene>& scene = scenes_[key(input, options)];
  if (!scene) {
    LoadOptions shared = options;  // what a job decides for itself
    shared.camera.clear();
    shared.hide_environment = false;
    const PromptExit prompt_exit(interrupted_early);
    scene = std::make_shared<const LoadedScene>(load_scene(input, shared));
    for (const std::string& warning : scene->scene.warnings) warn(warning);
  }
  return scene;
}

std::string job_fingerprint(const RenderJob& job) {
  std::string text;
  for (const auto& [name, value] : job.texts)
    if (name != "threads" && name != "quiet" && name != "png")
      text += (text.empty() ? "" : " ") + name + "=" + value;
  return text;
}

bool is_finished(const RenderJob& job) {
  RenderSettings settings;
  apply_options(job.texts, job.source, settings);
  const int frames = std::max(1, settings.turntable);
  for (int frame = 1; frame <= frames; ++frame) {
    const fs::path file = settings.turntable > 0 ? numbered(job.output, frame) : job.output;
    if (!fs::exists(file)) return false;
    try {
      const ExrAttributes attributes = read_exr(file).attributes;
      const auto has = [&](const char* name, const std::string& value) {
        const auto found = attributes.find(name);
        return found != attributes.end() && found->second == value;
      };
      if (!has("alabaster.complete", "yes") || !has("alabaster.options", job_fingerprint(job))) return false;
    } catch (const InputError&) {
      return false;
    }
  }
  return true;
}

bool run_render_job(const RenderJob& job, SceneCache& scenes) {
  RenderSettings settings;
  apply_options(job.texts, job.source, settings);
  check_output(job.output, ".exr");
  if (!settings.png.empty()) check_output(settings.png, ".png");
  const std::shared_ptr<const LoadedScene> loaded = scenes.get(job.input, settings.load);
  const Scene& scene = loaded->scene;

  const RenderSettings given = std::exchange(settings, RenderSettings());
  apply_scene_defaults(loaded->integrator, job.input.string(), settings);
  if (given.time > 0 && !given.spp) settings.spp.reset();  // a time asked for now outranks the file's count
  apply_options(job.texts, job.source, settings);
  check_settings(settings);
  set_thread_count(settings.threads);

  const Camera camera = find_camera(scene, settings.camera);
  const int frames = std::max(1, settings.turntable);
  for (int frame = 0; frame < frames; ++frame) {
    const bool table = settings.turntable > 0;
    const fs::path output = table ? numbered(job.output, frame + 1) : job.output;
    const fs::path png =
        table && !settings.png.empty() ? numbered(settings.png, frame + 1) : fs::path(settings.png);
    if (frame == 0) say_angular_size(scene, settings);
    std::optional<PromptExit> prompt_exit(std::in_place, interrupted_early);
    const SurfaceIntegrator integrator(
        scene, surface_options(settings, scene, turned(camera, scene, 2 * pi * frame / frames)));
    prompt_exit.reset();
    const RenderResult result = render(integrator, render_options(settings, output.filename().string()));
    write_outputs(job, settings, result, output, png);
    say_closing_line(result, output);
    for (const std::string& line : integrator.report()) say(line);
    if (result.cancelled) return false;
  }
  return true;
}

}  // namespace alabaster
