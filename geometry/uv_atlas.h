#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "geometry/mesh.h"

namespace alabaster {

/// An edge of the surface where the UVs are cut: the same edge seen from both triangles, each from its own
/// corner `side` to corner `side + 1`.
struct UvSeam {
  uint32_t triangle = 0, other_triangle = 0;
  uint8_t side = 0, other_side = 0;
  bool reversed = true;  // the sides run in opposite directions, as neighbours wound alike do
};

/// Edges with exactly two triangles whose UVs differ there; each once, in the order of positions. Empty when
/// the mesh has no such set.
std::vector<UvSeam> find_uv_seams(const TriangleMesh& mesh, std::size_t uv_set = 0);

/// What the UV set of a mesh looks like from the surface: charts, and how lengths map.
class UvAtlas {
 public:
  UvAtlas() = default;
  explicit UvAtlas(const TriangleMesh& mesh, std::size_t uv_set = 0);

  /// The mesh has no such UV set; then nothing below may be asked.
  bool empty() const { return chart_of_triangle_.empty(); }
  /// Triangles that share an edge with equal UVs on it belong to one chart.
  uint32_t chart(uint32_t triangle) const { return chart_of_triangle_[triangle]; }
  std::size_t chart_count() const { return chart_count_; }
  /// The 2 x 3 map from a displacement in metres (in the triangle's plane) to a displacement in UV; zero for
  /// triangles without area in space.
  Vec2 uv_from_surface(uint32_t triangle, const Vec3& displacement) const;
  /// The rows of that map: the gradients of u and v along the surface, 1/m.
  const std::array<Vec3f, 2>& gradients(uint32_t triangle) const { return gradients_[triangle]; }
  /// UV units per metre: sqrt of the area ratio. 0 where the triangle has no area in UV.
  double uv_per_metre(uint32_t triangle) const { return uv_per_metre_[triangle]; }

  std::size_t zero_area_triangles = 0;   // no area in UV
  std::size_t out_of_range_corners = 0;  // outside [0, 1]: tiled
  double overlap_fraction = 0;           // share of covered texels (512 x 512 raster) covered more than once
  std::size_t non_finite_corners = 0;

 private:
  void set_jacobian(const TriangleMesh& mesh, uint32_t triangle, const std::array<Vec2, 3>& uv);

  std::vector<uint32_t> chart_of_triangle_;
  std::vector<float> uv_per_metre_;
  std::vector<std::array<Vec3f, 2>> gradients_;  // rows of the 2 x 3 map
  std::size_t chart_count_ = 0;
};

}  // namespace alabaster
