#pragma once
// What the estimators of the planar reference share. Private to integrators/planar_*.cpp.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/rng.h"
#include "core/vec.h"
#include "integrators/planar_scene.h"

namespace alabaster {

/// One photon or camera path, in optical lengths.
struct PlanarPath {
  Vec3 position{0};                       // z = depth
  Vec3 direction{0};                      // unit, z downwards
  std::array<double, 3> weight{0, 0, 0};  // of the channels that share it
};

/// An independent part of a result.
struct PlanarBatch {
  PlanarBatch(uint64_t seed, std::size_t index) : rng(seed, index) {}
  Rng rng;
  std::vector<double> sums;       // three per pixel
  std::vector<PlanarPath> split;  // copies still to be followed
  uint64_t walks = 0, collisions = 0;
};

/// Traces the paths of some channels, which share them.
class PlanarLane {
 public:
  virtual ~PlanarLane() = default;
  /// Adds `walks` more, a multiple of walks_at_once(), to the batch's sums and collisions.
  virtual void run(PlanarBatch& batch, uint64_t walks) const = 0;
  virtual uint64_t walks_at_once() const { return 1; }
  /// How many paths a walk stands for, in the mean: what sums are divided by.
  virtual double paths_per_walk() const = 0;
};

/// The direction inside, z downwards, that the boundary refracts towards the camera.
inline Vec3 seen_inside(const PlanarScene& scene) {
  const Vec2 lateral = Vec2(scene.view.towards) / scene.medium.eta;
  return Vec3(lateral, -std::sqrt(1 - glm::dot(lateral, lateral)));
}

/// The weight a photon should have at a place: constant below the light and falling around it about as the
/// light does, so that the dim pixels get their share of photons too.
class TargetWeight {
 public:
  static constexpr double under_light = 0.25;

  TargetWeight(const PlanarScene& scene, double mean_free_path, bool from_light) {
    if (!from_light) return;
    const Medium& medium = scene.medium;
    const double reach = scene.light.radius / mean_free_path;
    centre_ = scene.light.centre / mean_free_path;
    reach_squared_ = reach * reach;
    // A quarter of diffusion's decay at the mean albedo: following all of it would spend most of the time
    // where there is least to see.
    const double albedo = mean_albedo(*scene.albedo).max();
    const double decay = 0.25 * std::sqrt(3 * (1 - albedo) * (1 - medium.g * albedo));
    farthest_ = reach + farthest_corner(scene) / mean_free_path;
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const double beyond = std::max(
          0.0, farthest_ * (static_cast<double>(i) + 0.5) / static_cast<double>(table_.size()) - reach);
      table_[i] = under_light * std::exp(-decay * beyond);
    }
  }

  double at(Vec2 optical) const { return around_centre(optical - centre_); }
  double around_centre(Vec2 offset) const {
    const double squared = glm::dot(offset, offset);
    if (squared <= reach_squared_) return under_light;
    const double position = std::sqrt(squared) / farthest_ * static_cast<double>(table_.size());
    return table_[static_cast<std::size_t>(std::min(position, static_cast<double>(table_.size() - 1)))];
  }

 private:
  // From the light's centre to the corner of the view that is farthest away, m.
  static double farthest_corner(const PlanarScene& scene) {
    const Vec2 to_view = glm::abs(scene.view.centre - scene.light.centre) + 0.5 * scene.view.size;
    return glm::length(to_view);
  }

  Vec2 centre_{0};
  double reach_squared_ = std::numeric_limits<double>::infinity(), farthest_ = 1;
  std::array<double, 64> table_{};
};

}  // namespace alabaster
