#pragma once

#include <cstdint>

#include "bssrdf/kernel_placement.h"
#include "geometry/mesh.h"
#include "geometry/ray_scene.h"
#include "geometry/uv_atlas.h"

namespace alabaster {

/// An unbounded plane whose UVs depend affinely on position: exactly [EK17] eq. 1. The points' UVs are not
/// wrapped.
class PlanarPlacement final : public KernelPlacement {
 public:
  /// `uv_from_surface` maps metres along the surface's Frame(geometric normal) tangent and bitangent to UV.
  explicit PlanarPlacement(const Mat2& uv_from_surface) : uv_from_surface_(uv_from_surface) {}
  void place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
             std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const override;
  KernelFootprint around(const SurfacePoint& point, double sigma) const override;

 private:
  Mat2 uv_from_surface_;
};

/// Points of the chord between entry and exit, carried to the surface. Where both ends lie in one chart whose
/// metric carries the chord about onto the UV difference: by the cubic through both UVs with the slopes that
/// the Jacobians give the projected chord there (constant time, exact on a plane). By closest-point queries
/// elsewhere.
class ProjectedChordPlacement final : public KernelPlacement {
 public:
  /// How far a Jacobian's image of the chord may be off the UV difference, as a fraction of it, for the cubic
  /// to be used.
  static constexpr double default_tolerance = 0.5;

  /// `object` is the mesh's id in `rays`; everything referred to outlives this. A negative tolerance always
  /// queries.
  ProjectedChordPlacement(const TriangleMesh& mesh, const UvAtlas& atlas, const RayScene& rays,
                          uint32_t object, double tolerance = default_tolerance);

  void place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
             std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const override;
  KernelFootprint around(const SurfacePoint& point, double sigma) const override;

  /// Whether place() needs no closest-point query for this pair.
  bool interpolates(const SurfacePoint& entry, const SurfacePoint& exit) const;

 private:
  void place_by_queries(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
                        std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const;
  const TriangleMesh& mesh_;
  const UvAtlas& atlas_;
  const RayScene& rays_;
  uint32_t object_;
  double tolerance_;
};

}  // namespace alabaster
