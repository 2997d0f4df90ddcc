#pragma once

#include <array>

#include "geometry/surface_point.h"
#include "texture/albedo_field.h"

namespace alabaster {

/// [EK17] eq. 1: three isotropic Gaussians with weights w = t = {4, 2, 1}/7, means x_i + t_k (x_e - x_i),
/// standard deviations t_k d.
struct AggregationKernel {
  static constexpr std::array<double, 3> t{4.0 / 7, 2.0 / 7, 1.0 / 7};
  static constexpr std::array<double, 3> weight{4.0 / 7, 2.0 / 7, 1.0 / 7};
};

/// Answers: for (x_i, x_e) on the mesh, where in the UV atlas lies a point at fraction t of the way from
/// entry to exit, and what is a Gaussian's footprint there. Approximations are interchangeable; on a plane
/// all agree with [EK17] exactly. Thread-safe.
class KernelPlacement {
 public:
  virtual ~KernelPlacement() = default;
  /// Fills one footprint per t; sigma is t * distance along the surface.
  virtual void place(const SurfacePoint& entry, const SurfacePoint& exit, const std::array<double, 3>& t,
                     std::array<KernelFootprint, 3>& footprints) const = 0;
};

}  // namespace alabaster
