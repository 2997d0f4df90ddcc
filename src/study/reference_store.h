#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "study/mesh_scene.h"
#include "study/method_result.h"
#include "study/planar_method.h"

namespace alabaster {

/// How good a reference has to be.
struct ReferenceGoal {
  double noise = 0.05;      // RMSE / RMS of the image
  uint32_t max_spp = 2048;  // samples per pixel after which it is taken as it is
  uint64_t seed = 1;
};

/// Converged reference images, kept in a folder under a hash of all that decides them: the scene's content,
/// the image's options, the transport and the reference's version. What lies there is taken when it is good
/// enough and continued, with further independent samples, when it is not. Every image is an EXR of its own;
/// deleting the folder is safe.
class ReferenceStore {
 public:
  explicit ReferenceStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The image of the scene by random walks that read the albedo at the closest surface point; where
  /// `constant` is set (one albedo per object) by walks that need not ask. Its times are those of the whole
  /// image, whenever they were spent. Nothing when a stop was asked for before the first image was ready.
  std::optional<TimedImage> get(const MeshScene& scene, bool constant, const ReferenceGoal& goal);

  /// render_planar_reference(), kept under its arguments.
  TimedImage get(const PlanarScene& scene, double noise, double known, uint64_t max_paths, uint64_t seed);

  std::filesystem::path file_of(const MeshScene& scene, bool constant, uint64_t seed) const;

 private:
  std::filesystem::path folder_;
};

/// $XDG_CACHE_HOME/alabaster/references, else ~/.cache/alabaster/references.
std::filesystem::path default_reference_folder();

/// The mean of two independent images of different sample counts, with its variance.
TimedImage merged(const TimedImage& a, const TimedImage& b);

}  // namespace alabaster
