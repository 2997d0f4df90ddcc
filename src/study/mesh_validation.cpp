#include "study/mesh_validation.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/cancellation.h"
#include "core/progress.h"

namespace alabaster {

namespace {

bool known_to_a_tenth(const Rgb& value, const Rgb& variance) {
  for (int c = 0; c < 3; ++c)
    if (!(value[c] > 10 * std::sqrt(variance[c]))) return false;
  return true;
}

/// The method on one albedo per object. Models that differ by their treatment of texture alone are one there.
std::string flat_key(const MeshMethod& method) {
  return method.transport == Transport::bssrdf ? "bssrdf " + method.basis + " " + method.distance : "walk";
}

void add_causes(const MeshMethod& method, const Image& truth, const Image& flat_truth,
                MeshMethodResult& result) {
  result.sampling_noise = noise_of(result.render.image);
  result.shape = compare_images(result.flat_render.image, flat_truth);
  if (method.transport != Transport::bssrdf) {  // walks know the shape: all their error is the texture's
    result.aggregation = result.errors;
    result.aggregation_pixels = 1;
    return;
  }
  const CorrectedImage image = corrected(result.render.image, flat_truth, result.flat_render.image);
  CompareOptions where;
  where.mask = image.known;
  const auto known = std::count(image.known.begin(), image.known.end(), true);
  if (known == 0) return;
  result.aggregation = compare_images(image.image, truth, where);
  std::ptrdiff_t lit = 0;
  for (int y = 0; y < truth.height(); ++y)
    for (int x = 0; x < truth.width(); ++x) lit += flat_truth.rgb(0, x, y).is_black() ? 0 : 1;
  result.aggregation_pixels =
      static_cast<double>(known) / static_cast<double>(std::max<std::ptrdiff_t>(1, lit));
}

}  // namespace

CorrectedImage corrected(const Image& a, const Image& correction, const Image& divisor) {
  CorrectedImage result{
      Image(a.width(), a.height(), {"R", "G", "B", "variance.R", "variance.G", "variance.B"}), {}};
  const auto variance_of = [](const Image& image) { return *find_layer(image, "variance"); };
  const ColourChannels va = variance_of(a), vc = variance_of(correction), vd = variance_of(divisor);
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const Rgb value = a.rgb(0, x, y), c = correction.rgb(0, x, y), d = divisor.rgb(0, x, y);
      const bool known =
          known_to_a_tenth(c, vc.get(correction, x, y)) && known_to_a_tenth(d, vd.get(divisor, x, y));
      result.known.push_back(known);
      if (!known) continue;
      const Rgb factor = c / d;
      result.image.set_rgb(0, x, y, value * factor);
      // Relative variances add up; to first order in them, which 10 % allows.
      const Rgb relative = vc.get(correction, x, y) / (c * c) + vd.get(divisor, x, y) / (d * d);
      result.image.set_rgb(3, x, y, factor * factor * (va.get(a, x, y) + value * value * relative));
    }
  return result;
}

MeshSceneResult measure_mesh(const std::string& name, const std::vector<MeshMethod>& methods,
                             const MeshBudget& budget, ReferenceStore& store, uint64_t seed) {
  MeshScene scene = load_mesh_scene(name, budget.resolution);
  MeshSceneResult result;
  result.name = scene.name;
  result.title = scene.title;
  result.skipped = obstacle_to_reference(scene);
  if (!result.skipped.empty()) {
    warn(result.skipped + " (left out)");
    return result;
  }
  const ReferenceGoal goal{budget.reference_noise, budget.max_spp, seed};
  auto reference = store.get(scene, false, goal);
  if (!reference || cancellation_requested()) return result;
  for (const MeshMethod& method : methods) {
    MeshMethodResult measured;
    measured.model = method.name;
    measured.render = render_mesh(scene, method, budget.spp, seed + 1);
    measured.errors = compare_images(measured.render.image, reference->image);
    result.methods.push_back(std::move(measured));
  }
  flatten_albedo(scene.scene);
  auto flat_reference = store.get(scene, true, goal);
  std::map<std::string, TimedImage> flat;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const std::string key = flat_key(methods[i]);
    if (flat.count(key) == 0) flat[key] = render_mesh(scene, methods[i], 2 * budget.spp, seed + 2);
    result.methods[i].flat_render = flat[key];
  }
  if (!flat_reference || cancellation_requested()) {
    result.methods.clear();
    return result;
  }
  result.reference = std::move(*reference);
  result.flat_reference = std::move(*flat_reference);
  for (std::size_t i = 0; i < methods.size(); ++i)
    add_causes(methods[i], result.reference.image, result.flat_reference.image, result.methods[i]);
  return result;
}

}  // namespace alabaster
