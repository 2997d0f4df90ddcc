#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/vec.h"
#include "geometry/surface_point.h"

namespace alabaster {

using Index3 = std::array<uint32_t, 3>;
inline constexpr uint32_t no_index = std::numeric_limits<uint32_t>::max();

/// One object's triangles as plain arrays, in metres and world space. Positions are welded: a position that
/// several corners share appears once. What may differ from corner to corner of one position (normal, UV,
/// colour, tangent) stands in the attribute arrays, which `attributes` indexes; `corners` indexes
/// `positions`.
struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<Index3> corners;              // one per triangle, into positions
  std::vector<Index3> attributes;           // one per triangle, into the arrays below
  std::vector<Vec3f> normals;               // unit
  std::vector<std::vector<Vec2f>> uv_sets;  // glTF convention: v runs downwards in the image; may be empty
  std::vector<Vec4f> tangents;      // xyz unit, w the bitangent's sign; empty when no material needs it
  std::vector<Vec4f> colours;       // linear RGBA; empty when there are none
  std::vector<uint16_t> materials;  // one per triangle

  std::size_t triangle_count() const { return corners.size(); }

  Vec3 position(uint32_t triangle, Vec2 barycentric) const;
  /// Unit normal of the plane of the triangle, by its winding.
  Vec3 geometric_normal(uint32_t triangle) const;
  double area(uint32_t triangle) const;
  /// (0, 0) where the mesh has no such set.
  Vec2 uv(uint32_t triangle, Vec2 barycentric, std::size_t set = 0) const;
  /// Position, both normals and UV set 0 at a point of a triangle. The shading normal lies on the side of the
  /// geometric normal.
  SurfacePoint surface_point(uint32_t triangle, Vec2 barycentric) const;
};

struct BoundingBox {
  Vec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  void extend(const Vec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  void extend(const BoundingBox& o) { extend(o.low), extend(o.high); }
  bool empty() const { return !(low.x <= high.x); }
  Vec3 centre() const { return 0.5 * (low + high); }
  double diagonal() const { return empty() ? 0 : glm::length(high - low); }
};

BoundingBox bounding_box(const TriangleMesh& mesh);
double surface_area(const TriangleMesh& mesh);
/// Enclosed volume by the divergence theorem; meaningful for closed meshes, negative when turned inside out.
double enclosed_volume(const TriangleMesh& mesh);

/// Area-weighted smooth normals over the welded positions, for meshes that come without.
void compute_smooth_normals(TriangleMesh& mesh);
/// One normal per triangle (glTF: a primitive without normals is flat shaded).
void compute_flat_normals(TriangleMesh& mesh);
/// Tangents from UV set `set` and the normals.
void compute_tangents(TriangleMesh& mesh, std::size_t set);

}  // namespace alabaster
