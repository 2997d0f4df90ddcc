#pragma once

#include <cstdint>
#include <memory>

#include "image/image.h"
#include "integrators/planar_scene.h"

namespace alabaster {

/// The estimators of one image; they differ in their noise, not in their mean.
enum class PlanarEstimator {
  /// Photons from the lit patch; every collision scores, by its exact probability, into the pixel that sees
  /// it. One path serves all pixels: the fast one. Not for light on the whole plane.
  from_light,
  /// The same photons, a lattice of them over the whole light at once: all take one and the same walk, which
  /// depends on no albedo, and differ in where they start and hence in what they meet. Tens to hundreds of
  /// times cheaper, but neighbouring pixels err alike. Not for light on the whole plane.
  lattice,
  /// Paths from each pixel, which score wherever they meet the boundary below the light.
  from_camera,
  /// The oracle of both: paths from each pixel, absorbed or not, out or not, by chance alone; counts.
  analog,
};

struct PlanarVolumeOptions {
  PlanarEstimator estimator = PlanarEstimator::from_light;
  uint64_t seed = 1;
};

/// Volumetric path tracer of the heterogeneous half-space: the truth of the planar laboratory. Albedo from
/// the texture, bilinear, straight above; Henyey-Greenstein; smooth dielectric boundary; light that scattered
/// at least once. Results depend on the seed and the number of paths, not on the number of threads.
class PlanarVolume {
 public:
  /// Throws InputError where the scene is wrong or the estimator cannot serve it.
  PlanarVolume(const PlanarScene& scene, const PlanarVolumeOptions& options);
  ~PlanarVolume();

  /// Adds about `paths` more (rounded up to whole batches; from the camera to whole images, on the lattice to
  /// sixteen walks). A path serves all channels when their mean free paths agree; on the lattice every photon
  /// counts as one.
  void run(uint64_t paths);

  /// R G B A, variance.R/.G/.B (of the mean, from 32 independent batches), samples.Y (paths per pixel).
  Image develop() const;
  /// sqrt(mean variance / mean square) over pixels and channels.
  double noise() const;

  uint64_t paths() const;
  uint64_t collisions() const;
  double cpu_seconds() const;  // spent in run(), over all threads

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The one that needs the least time: the lattice wherever the light is wide enough to hold one.
PlanarEstimator cheapest_estimator(const PlanarScene& scene);

/// Runs until noise() is below `noise`, at most `max_paths`; stops early when cancellation was asked for.
void run_to_noise(PlanarVolume& volume, double noise, uint64_t max_paths);

}  // namespace alabaster
