#include "study/reference_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/cancellation.h"
#include "core/error.h"
#include "core/progress.h"
#include "core/rng.h"
#include "core/user_cache.h"
#include "image/exr_file.h"
#include "integrators/render.h"
#include "study/mesh_method.h"
#include "study/scene_fingerprint.h"

namespace alabaster {

namespace fs = std::filesystem;

namespace {

/// To be raised whenever the expectation of the reference's images changes: what was kept is then of no use.
constexpr int reference_version = 1;

constexpr uint32_t first_batch = 32;  // samples per pixel: enough for a first guess at the noise

struct Stored {
  TimedImage render;
  uint32_t batches = 0;  // independent ones it was merged from
  uint32_t spp = 0;
};

double number(const ExrAttributes& attributes, const char* name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? 0 : std::strtod(found->second.c_str(), nullptr);
}

Stored load(const fs::path& file) {
  Stored stored;
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return stored;
  try {
    ExrFile exr = read_exr(file);
    stored.batches = static_cast<uint32_t>(number(exr.attributes, "alabaster.batches"));
    stored.spp = static_cast<uint32_t>(number(exr.attributes, "alabaster.spp"));
    stored.render = {std::move(exr.image), number(exr.attributes, "alabaster.seconds"),
                     number(exr.attributes, "alabaster.cpu_seconds"),
                     static_cast<uint64_t>(number(exr.attributes, "alabaster.samples"))};
  } catch (const InputError& error) {
    warn(std::string(error.what()) + "; rendering it anew");
    return {};
  }
  return stored.batches > 0 && stored.spp > 0 ? stored : Stored{};
}

void save(const fs::path& file, const std::string& scene, const Stored& stored) {
  try {
    write_exr(file, stored.render.image,
              {{"alabaster.scene", scene},
               {"alabaster.batches", std::to_string(stored.batches)},
               {"alabaster.spp", std::to_string(stored.spp)},
               {"alabaster.samples", std::to_string(stored.render.samples)},
               {"alabaster.seconds", fmt::format("{:.3f}", stored.render.seconds)},
               {"alabaster.cpu_seconds", fmt::format("{:.3f}", stored.render.cpu_seconds)}});
  } catch (const InputError& error) {
    warn(std::string(error.what()) + " (the reference is not kept)");
  }
}

/// Samples per pixel to add next; 0 when it is good enough.
uint32_t next_batch(const Stored& stored, const ReferenceGoal& goal) {
  if (stored.spp == 0) return std::min(first_batch, goal.max_spp);
  const double noise = noise_of(stored.render.image);
  if (noise <= goal.noise || stored.spp >= goal.max_spp) return 0;
  // Variance falls as 1 / samples; a little more than that, so that the last step need not be repeated. The
  // first guess may be wrong by a lot: at most eight times what there is.
  const double wanted = 1.05 * stored.spp * (noise * noise) / (goal.noise * goal.noise);
  const double most = std::min<double>(goal.max_spp, 8.0 * stored.spp);
  return std::max<uint32_t>(static_cast<uint32_t>(std::min(wanted, most)), stored.spp + 4) - stored.spp;
}

}  // namespace

TimedImage merged(const TimedImage& a, const TimedImage& b) {
  const double total = static_cast<double>(a.samples + b.samples);
  const double wa = static_cast<double>(a.samples) / total, wb = static_cast<double>(b.samples) / total;
  TimedImage result = a;
  for (std::size_t c = 0; c < a.image.channels().size(); ++c) {
    const std::string& name = a.image.channels()[c];
    const int channel = static_cast<int>(c), other = b.image.find(name);
    double fa = wa, fb = wb;
    if (name.rfind("variance.", 0) == 0) fa = wa * wa, fb = wb * wb;
    if (name == "samples.Y") fa = fb = 1;
    for (int y = 0; y < a.image.height(); ++y)
      for (int x = 0; x < a.image.width(); ++x)
        result.image.at(channel, x, y) =
            static_cast<float>(fa * a.image.at(channel, x, y) + fb * b.image.at(other, x, y));
  }
  result.seconds += b.seconds;
  result.cpu_seconds += b.cpu_seconds;
  result.samples += b.samples;
  return result;
}

fs::path ReferenceStore::file_of(const MeshScene& scene, bool constant, uint64_t seed) const {
  const SurfaceOptions options = scene.options();
  return folder_ / fmt::format("{}_{}x{}_depth{}_{}_v{}_seed{}.exr", scene_fingerprint(scene.scene),
                               options.width, options.height, options.depth, constant ? "constant" : "volume",
                               reference_version, seed);
}

std::optional<TimedImage> ReferenceStore::get(const MeshScene& scene, bool constant,
                                              const ReferenceGoal& goal) {
  const fs::path file = file_of(scene, constant, goal.seed);
  Stored stored = load(file);
  SurfaceOptions options = scene.options();
  options.transport = constant ? Transport::walk : Transport::volume;
  const SurfaceIntegrator integrator(scene.scene, options);
  while (const uint32_t spp = next_batch(stored, goal)) {
    const std::string label = scene.name + (constant ? " reference, one albedo" : " reference");
    TimedImage batch = render_timed(integrator, label, spp, hash_combine(goal.seed, stored.batches));
    if (cancellation_requested()) break;  // the batch is not whole
    stored.render = stored.batches == 0 ? std::move(batch) : merged(stored.render, batch);
    ++stored.batches;
    stored.spp += spp;
    save(file, scene.name, stored);
  }
  if (stored.batches == 0) return std::nullopt;
  return std::move(stored.render);
}

TimedImage ReferenceStore::get(const PlanarScene& scene, double noise, double known, uint64_t max_paths,
                               uint64_t seed) {
  const fs::path file =
      folder_ / fmt::format("{}_flat_noise{}_known{}_paths{}_v{}_seed{}.exr", scene_fingerprint(scene), noise,
                            known, max_paths, reference_version, seed);
  Stored stored = load(file);
  if (stored.batches > 0) return std::move(stored.render);
  stored = {render_planar_reference(scene, noise, known, max_paths, seed), 1, 1};
  if (!cancellation_requested()) save(file, scene.name, stored);
  return std::move(stored.render);
}

fs::path default_reference_folder() {
  return user_cache_folder() / "references";
}

}  // namespace alabaster
