#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "texture/albedo_field.h"

namespace alabaster {

/// Albedo from values at the vertices (COLOR_0 without a texture), linear inside a triangle. For Gaussians,
/// every position holds averages of doubling width, taken over the clusters of surface that hang together
/// with its own within three standard deviations: light does not leak between the two sides of a sheet, nor
/// over a gap. Between two widths the lookup blends by variance (error about 3 % of contrast). The mesh must
/// outlive it.
class VertexAlbedo : public AlbedoField {
 public:
  /// `albedo` has one alpha per attribute vertex of the mesh; `triangles` are those that wear it.
  VertexAlbedo(const TriangleMesh& mesh, std::span<const uint32_t> triangles, std::vector<Rgb> albedo);

  Rgb at(const SurfacePoint& point) const override { return at(point.triangle, point.barycentric); }
  Rgb filtered(const KernelFootprint& footprint) const override;
  Rgb max() const override { return max_; }
  std::size_t level_count() const { return levels_.size(); }

 private:
  Rgb at(uint32_t triangle, Vec2 barycentric) const;
  Rgb level_value(std::size_t level, uint32_t triangle, Vec2 barycentric) const;

  const TriangleMesh& mesh_;
  std::vector<Rgb> albedo_;
  std::vector<std::vector<Vec3f>> levels_;  // per position, deviations finest_ * 2^level
  double finest_ = 0;                       // m
  Rgb max_{0};
};

}  // namespace alabaster
