#pragma once

#include <optional>

#include "core/rng.h"
#include "scene/light_sampler.h"

namespace alabaster {

/// Directions that concentrated light comes from, for walks inside a medium, which would seldom leave towards
/// it by themselves. A guide only: what light there is, is for rays to find. Thread-safe.
class LightGuide {
 public:
  /// Both outlive the guide.
  LightGuide(const Scene& scene, const LightSampler& lights);

  struct Draw {
    Vec3 direction{0};  // unit, towards the light
    double pdf = 0;     // per solid angle
    double brightness = 0;
  };
  /// A direction from about `p`, above the horizon of `normal`; nothing where the draw found none.
  std::optional<Draw> sample(const Vec3& p, const Vec3& normal, Rng& rng) const;
  /// The density of sample().
  double pdf(const Vec3& p, const Vec3& normal, const Vec3& direction) const;
  /// What to expect along a direction, mean over channels: the lights, unoccluded, and a little for all else.
  double brightness(const Vec3& p, const Vec3& direction) const;

 private:
  const LightSampler& lights_;
  double unseen_;
};

}  // namespace alabaster
