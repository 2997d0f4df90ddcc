#pragma once

#include <span>

#include "geometry/surface_point.h"
#include "texture/albedo_field.h"

namespace alabaster {

/// One isotropic Gaussian (or, with sigma 0, one sample) of an aggregation kernel, in the frame of a pair:
/// lengths are fractions of the distance d between entry and exit.
struct KernelTap {
  double along = 0;   // 0 at the entry, 1 at the exit
  double across = 0;  // sideways, in the surface
  double sigma = 0;   // standard deviation
  double weight = 1;
};

/// Answers: for (x_i, x_e) on the mesh, where in the UV atlas does each tap of a kernel lie, and what is its
/// footprint there. Approximations are interchangeable; on a plane all agree with [EK17] eq. 1 exactly.
/// Thread-safe.
class KernelPlacement {
 public:
  virtual ~KernelPlacement() = default;
  /// Fills footprints[k] for taps[k]; the spans are equally long. `distance` is |x_e - x_i|, m, > 0.
  virtual void place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
                     std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const = 0;
  /// A Gaussian around one point, moved by `offset` in its tangent plane; `sigma` and `offset` in metres. One
  /// that is moved is meant to be about as wide as that is long at least: charts and curvature are not asked.
  virtual KernelFootprint around(const SurfacePoint& point, double sigma, const Vec3& offset) const = 0;
};

}  // namespace alabaster
