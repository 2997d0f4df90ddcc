#include "study/planar_method.h"

#include <algorithm>
#include <charconv>

#include "core/cancellation.h"
#include "core/error.h"
#include "core/parallel.h"
#include "integrators/planar_volume.h"
#include "integrators/render.h"

namespace alabaster {

namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

template <class Number>
bool parse_number(const std::string& text, Number& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

bool apply_variant(PlanarMethod& method, const std::string& variant) {
  if (variant == "uniform" || variant == "profile" || variant == "mis" || variant == "clipped") {
    method.sampling = planar_sampling_from_name(variant);
    return true;
  }
  if (method.model == "composite" && (variant == "symmetric" || variant == "order1" || variant == "view")) {
    method.model += ":" + variant;
    return true;
  }
  if (method.model != "aggregate") return false;
  if (variant.rfind("mc", 0) == 0)
    return parse_number(variant.substr(2), method.options.ellipse_samples) &&
           method.options.ellipse_samples > 0;
  return parse_number(variant, method.options.ellipse_width) && method.options.ellipse_width >= 0;
}

}  // namespace

PlanarMethod parse_planar_method(const std::string& name) {
  const std::vector<std::string> parts = split(name, ':');
  PlanarMethod method;
  method.name = name;
  method.model = parts[0];
  const std::vector<std::string> models{"homogeneous", "factorized", "aggregate", "composite"};
  if (std::find(models.begin(), models.end(), method.model) == models.end())
    throw InputError("there is no model '" + name + "'; use homogeneous, factorized, aggregate or composite");
  for (std::size_t i = 1; i < parts.size(); ++i)
    if (!apply_variant(method, parts[i]))
      throw InputError(
          "model '" + name + "': there is no variant '" + parts[i] +
          "'; composite takes symmetric, order1 and view, aggregate its ellipse's width (0.5) and mc64, "
          "all take uniform, profile, mis and clipped");
  return method;
}

TimedImage render_planar(const PlanarScene& scene, const PlanarMethod& method, const ProfileTable& profile,
                         uint32_t spp, uint64_t seed) {
  const PlanarModel model(scene, method.model, profile, method.options);
  const PlanarIntegrator integrator(model, method.sampling);
  RenderOptions options;
  options.spp = spp;
  options.seed = seed;
  options.label = scene.name + " " + method.name;
  RenderResult result = render(integrator, options);
  return {result.film.develop(), result.seconds, result.cpu_seconds, result.samples};
}

TimedImage render_planar_reference(const PlanarScene& scene, double noise, double known, uint64_t max_paths,
                                   uint64_t seed) {
  const double start = wall_seconds();
  PlanarVolumeOptions options;
  options.seed = seed;
  options.estimator = cheapest_estimator(scene);
  // A photon on the lattice costs about a hundredth of one that walks by itself.
  if (options.estimator == PlanarEstimator::lattice) max_paths *= 100;
  PlanarVolume volume(scene, options);
  run_to_noise(volume, noise, max_paths);
  Image image = volume.develop();
  while (known > 0 && compare_images(image, image).kept < known && volume.paths() < max_paths &&
         !cancellation_requested()) {
    volume.run(std::min(volume.paths() / 2, max_paths - volume.paths()));
    image = volume.develop();
  }
  return {std::move(image), wall_seconds() - start, volume.cpu_seconds(), volume.paths()};
}

}  // namespace alabaster
