#include "texture/surface_albedo.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace alabaster {

namespace {

// A pyramid is worth about 1.5 texels to read; below that the texture itself is as good.
constexpr double least_texels = 1.5;
// Nodes of all levels per squared finest spacing of surface (measured: docs/pyramids.md), and how many may
// always be had.
constexpr double nodes_per_area = 50;
constexpr std::size_t free_nodes = 1 << 18;
// The field answers up to this share of the finest variance of the pyramid.
constexpr double field_until = 0.5;

}  // namespace

SurfaceAlbedo::SurfaceAlbedo(const TriangleMesh& mesh, std::unique_ptr<AlbedoField> field,
                             std::vector<std::shared_ptr<const SurfacePyramid>> pyramids)
    : mesh_(mesh), field_(std::move(field)), pyramids_(std::move(pyramids)) {
  for (const uint16_t material : mesh.materials) {
    assert(material < pyramids_.size());
    const SurfacePyramid* pyramid = pyramids_[material].get();
    if (pyramid != nullptr) by_position_from_ = std::max(by_position_from_, pyramid->finest_sigma());
  }
  if (by_position_from_ == 0) by_position_from_ = std::numeric_limits<double>::infinity();
}

Rgb SurfaceAlbedo::filtered(const KernelFootprint& footprint) const {
  const SurfacePyramid* pyramid = pyramids_[mesh_.materials[footprint.triangle]].get();
  if (pyramid == nullptr) return field_->filtered(footprint);
  const double finest = pyramid->finest_sigma();
  const double variance = footprint.sigma * footprint.sigma / (finest * finest);
  if (variance >= 1) return pyramid->filtered(footprint.position, footprint.sigma);
  if (!(variance > field_until)) return field_->filtered(footprint);
  KernelFootprint narrow = footprint;
  narrow.sigma = std::sqrt(field_until) * finest;
  const double share = (variance - field_until) / (1 - field_until);
  return share * pyramid->filtered(footprint.position, finest) + (1 - share) * field_->filtered(narrow);
}

double finest_pyramid_sigma(const TriangleMesh& mesh, std::span<const uint32_t> triangles, double texel_size,
                            std::size_t texels) {
  double area = 0;
  for (const uint32_t t : triangles) area += mesh.area(t);
  const auto nodes = static_cast<double>(std::max(texels, free_nodes));
  const double affordable = std::sqrt(nodes_per_area * area / nodes);
  return std::max(least_texels * texel_size, SurfacePyramid::sigma_of_spacing(affordable));
}

double texel_size(const TriangleMesh& mesh, const UvAtlas& atlas, std::span<const uint32_t> triangles,
                  const TextureMapping& mapping, int width, int height) {
  if (atlas.empty()) return 0;
  double area = 0, in_uv = 0;
  for (const uint32_t t : triangles) {
    const double scale = atlas.uv_per_metre(t), own = mesh.area(t);
    if (!(scale > 0) || !std::isfinite(scale)) continue;
    area += own;
    in_uv += own * scale * scale;
  }
  const double texels = in_uv * std::abs(glm::determinant(mapping.linear_part())) * width * height;
  return texels > 0 ? std::sqrt(area / texels) : 0;
}

bool is_affine(const TriangleMesh& mesh, const UvAtlas& atlas, std::span<const uint32_t> triangles) {
  if (atlas.empty() || triangles.empty()) return false;
  const uint32_t first = triangles.front();
  const Vec3 normal = mesh.geometric_normal(first), origin = mesh.positions[mesh.corners[first][0]];
  const auto& [u, v] = atlas.gradients(first);
  const float allowed = 1e-4f * std::max(glm::length(u), glm::length(v));
  double extent = 0, height = 0;
  for (const uint32_t t : triangles) {
    if (atlas.chart(t) != atlas.chart(first) || glm::dot(mesh.geometric_normal(t), normal) < 1 - 1e-9)
      return false;
    if (glm::distance(atlas.gradients(t)[0], u) > allowed ||
        glm::distance(atlas.gradients(t)[1], v) > allowed)
      return false;
    for (const uint32_t corner : mesh.corners[t]) {
      const Vec3 offset = mesh.positions[corner] - origin;
      extent = std::max(extent, glm::length(offset));
      height = std::max(height, std::abs(glm::dot(normal, offset)));
    }
  }
  return height <= 1e-5 * extent;
}

}  // namespace alabaster
