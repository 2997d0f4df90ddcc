#pragma once

#include <cstddef>
#include <limits>
#include <span>

#include "core/rgb.h"
#include "core/vec.h"
#include "geometry/surface_point.h"

namespace alabaster {

/// Where a Gaussian of the aggregation kernel lies on the surface.
struct KernelFootprint {
  Vec2 uv{0};             // of its mean, set 0 of the mesh
  Vec2 barycentric{0};    // of its mean
  uint32_t triangle = 0;  // that holds the mean
  double sigma = 0;       // standard deviation on the surface, m
  Mat2 uv_from_surface{
      0.0};          // metres in the tangent plane -> UV; the Gaussian's covariance in UV is sigma^2 J J^T
  Vec3 position{0};  // of the mean in space, m: on the surface or within about sigma of it
};

/// The single-scattering albedo over one object's surface: the one function that gives the albedo of a
/// surface point, used by every model and by the reference (docs/theory.md). Thread-safe.
class AlbedoField {
 public:
  virtual ~AlbedoField() = default;
  /// alpha at a point: bilinear at the finest level, weighted by UV coverage.
  virtual Rgb at(const SurfacePoint& point) const = 0;
  /// alpha averaged by a Gaussian on the surface. One pyramid lookup.
  virtual Rgb filtered(const KernelFootprint& footprint) const = 0;
  /// The sum of filtered() of several footprints, each times its weight; the spans are equally long.
  virtual Rgb mixture(std::span<const KernelFootprint> footprints, std::span<const double> weights) const {
    Rgb sum;
    for (std::size_t k = 0; k < footprints.size(); ++k) sum += weights[k] * filtered(footprints[k]);
    return sum;
  }
  /// Footprints of at least this deviation, m, are answered from `position`, `sigma` and `triangle` (for its
  /// material) alone: whoever places them need not know the UV there.
  virtual double by_position_from() const { return std::numeric_limits<double>::infinity(); }
  /// The largest alpha anywhere, per channel: bounds for sampling.
  virtual Rgb max() const = 0;
};

}  // namespace alabaster
