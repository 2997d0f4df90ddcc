#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bssrdf/kernel_placement.h"
#include "geometry/geodesic.h"
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
  KernelFootprint around(const SurfacePoint& point, double sigma, const Vec3& offset) const override;

 private:
  Mat2 uv_from_surface_;
};

/// What a placement on a mesh is made from; all referred to outlives it.
struct PlacementBody {
  const TriangleMesh* mesh = nullptr;
  const UvAtlas* atlas = nullptr;  // of the mesh; may be empty
  const RayScene* rays = nullptr;
  uint32_t object = 0;  // the mesh's id in `rays`
  /// AlbedoField::by_position_from() of the field that reads the footprints.
  double by_position_from = std::numeric_limits<double>::infinity();
};

/// Means on the chord itself, as eq. 1 has them; constant time. Wide taps are a place in space and no more.
/// Narrow ones, which resolve the texture, need a UV: where both ends lie in one chart whose metric carries
/// the chord about onto the UV difference, by the cubic through both UVs with the slopes that the Jacobians
/// give the projected chord there (exact on a plane); else in the tangent plane of the nearer end. A tap
/// farther than its own width from both ends, for which that would not do, is a closest-point query: kernels
/// that widen with the distance from their end, as eq. 1's, have none.
class ChordPlacement : public KernelPlacement {
 public:
  /// How far a Jacobian's image of the chord may be off the UV difference, as a fraction of it: the cubic
  /// alone up to the first, the tangent planes alone from the second.
  static constexpr double full_trust = 0.4, no_trust = 0.5;

  explicit ChordPlacement(const PlacementBody& body) : body_(body) {}
  void place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
             std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const override;
  KernelFootprint around(const SurfacePoint& point, double sigma, const Vec3& offset) const override;

  /// How much the cubic counts for a pair, 0 to 1.
  double trust(const SurfacePoint& entry, const SurfacePoint& exit) const;

 protected:
  /// A pair with its way from entry to exit: the chord and what bends it at either end, as Hermite's cubic
  /// has it.
  struct Way {
    const SurfacePoint &entry, &exit;
    double distance;  // that deviations are fractions of
    Vec3 chord, side{0}, bend_at_entry{0}, bend_at_exit{0};
    Vec3 point(const KernelTap& tap) const;
  };
  void place_along(const Way& way, std::span<const KernelTap> taps,
                   std::span<KernelFootprint> footprints) const;
  const PlacementBody& body() const { return body_; }

 private:
  struct UvPair;
  UvPair uv_pair(const SurfacePoint& entry, const SurfacePoint& exit) const;
  void place_in_uv(const Way& way, const UvPair& pair, const KernelTap& tap, KernelFootprint& f) const;
  PlacementBody body_;
};

/// The chord bent into the cubic that leaves both ends along the surface (shading normals), deviations
/// fractions of the normal-corrected chord's length: constant time, hugs round surfaces.
class ArcPlacement final : public ChordPlacement {
 public:
  using ChordPlacement::ChordPlacement;
  void place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
             std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const override;
};

/// Points of the chord carried to the surface, each by a closest-point query.
class ProjectedChordPlacement final : public KernelPlacement {
 public:
  explicit ProjectedChordPlacement(const PlacementBody& body) : body_(body) {}
  void place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
             std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const override;
  KernelFootprint around(const SurfacePoint& point, double sigma, const Vec3& offset) const override;

 private:
  PlacementBody body_;
};

/// Means at fractions of the straightest path over the surface, deviations fractions of its length: tens of
/// microseconds. The chord's placement where no path arrives.
class StraightestPlacement final : public KernelPlacement {
 public:
  explicit StraightestPlacement(const PlacementBody& body);
  ~StraightestPlacement() override;
  void place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
             std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const override;
  KernelFootprint around(const SurfacePoint& point, double sigma, const Vec3& offset) const override;

 private:
  PlacementBody body_;
  ChordPlacement otherwise_;
  std::unique_ptr<HalfEdgeMesh> half_edges_;
  std::unique_ptr<GeodesicPath> path_;
};

/// chord, arc, projected-chord, straightest.
const std::vector<std::string>& placement_names();
/// Throws InputError, naming those that there are, for any other name.
std::unique_ptr<KernelPlacement> make_placement(std::string_view name, const PlacementBody& body);

inline constexpr std::string_view default_placement = "chord";

}  // namespace alabaster
