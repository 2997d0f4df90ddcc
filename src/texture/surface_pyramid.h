#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/rgb.h"
#include "core/vec.h"
#include "geometry/mesh.h"
#include "texture/albedo_field.h"
#include "texture/packed_texel.h"

namespace alabaster {

/// Gaussian averages of an albedo field over a surface, looked up by a place in space: no UV, so no seams, no
/// stretch and nothing outside a chart.
///
/// filtered(p, sigma) is the area-weighted mean of albedo under a Gaussian in space around p. On a plane it
/// is the Gaussian on the surface whatever p's height above it (its factor cancels); on a thin body it counts
/// both sides, as light in the volume does; it also counts what lies across an air gap narrower than sigma.
///
/// Levels of variances 2^(2/3) apart, each a grid of spacing h whose nodes hold the surface blurred by h^2,
/// kept in bricks of 8 x 8 x 8 nodes near the surface only; a lookup is trilinear in two of them: 16 nodes,
/// whatever sigma (8 at the finest). Nodes are held in 16 bits a channel; one albedo everywhere comes out
/// exactly. docs/pyramids.md has accuracy and cost. Thread-safe.
class SurfacePyramid {
 public:
  /// Reads field.at() over `triangles` of the mesh at points a fifth of the finest spacing apart. `finest` is
  /// the smallest standard deviation it will answer, m, > 0; it is raised where the object is more than 700
  /// times as large.
  SurfacePyramid(const TriangleMesh& mesh, std::span<const uint32_t> triangles, const AlbedoField& field,
                 double finest);

  /// The mean albedo around p, m, near the surface (within about sigma; farther out ever wider means answer).
  /// Below finest_sigma() the result is that of finest_sigma().
  Rgb filtered(const Vec3& p, double sigma) const;

  double finest_sigma() const { return finest_; }
  /// The standard deviation that a grid of this spacing answers, both m.
  static double sigma_of_spacing(double spacing);
  std::size_t level_count() const { return levels_.size(); }
  std::size_t memory_bytes() const;

 private:
  static constexpr int brick_nodes = 8, brick_cells = 7;  // neighbours share a layer of nodes
  static constexpr std::size_t brick_size = 512;

  struct Level {
    Vec3 origin{0};  // of node 0, m
    double nodes_per_metre = 0;
    std::array<int, 3> bricks{};  // along each axis
    std::vector<uint32_t> index;  // of the brick in `nodes`, or no_index
    std::vector<PackedTexel> nodes;
    float weight_unit = 0;          // of a code
    std::array<double, 3> limit{};  // largest node coordinate
  };
  class Splatting;
  Level blur(const Splatting& splats) const;
  Vec4f sum(const Level& level, const Vec3& p) const;

  std::vector<Level> levels_;
  double finest_ = 0;
  double inverse_finest_variance_ = 0;  // 1/m^2
  PackedRange range_;
};

}  // namespace alabaster
