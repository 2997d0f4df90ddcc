#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/rgb.h"
#include "core/sampler.h"
#include "geometry/surface_point.h"
#include "optics/light_aim.h"

namespace alabaster {

/// Where light that leaves a medium came in.
struct SubsurfaceEntry {
  SurfacePoint point;  // normals outwards
  /// Unit, outside, towards where the light comes from; without one the light of the whole hemisphere counts.
  std::optional<Vec3> direction;
  std::optional<LightAim> aim;  // of the hemisphere's light; absent: 1
  /// Times the irradiance that enters, E of docs/theory.md (W/m^2), or times the radiance that arrives
  /// along `direction`: an estimate of the radiance that leaves, but for the exit's transmission T(cos_o).
  Rgb weight;
};

/// How light that scattered at least once gets from where it enters the body of one medium to where it leaves
/// towards the camera. Light that never scattered is no part of it. Thread-safe.
class SubsurfaceTransport {
 public:
  virtual ~SubsurfaceTransport() = default;
  /// One entry for light that leaves `exit` (normals outwards) towards `viewer` (unit). Nothing where the
  /// draw found none: it counts as black.
  virtual std::optional<SubsurfaceEntry> sample(const SurfacePoint& exit, const Vec3& viewer,
                                                const Sampler& sampler, uint32_t occurrence) const = 0;
  /// What there is to say of the work done so far, in one line; empty when nothing.
  virtual std::string report() const { return {}; }
};

}  // namespace alabaster
