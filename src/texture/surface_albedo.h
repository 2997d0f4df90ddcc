#pragma once

#include <memory>
#include <span>
#include <vector>

#include "geometry/uv_atlas.h"
#include "texture/albedo_field.h"
#include "texture/surface_pyramid.h"
#include "texture/texture.h"

namespace alabaster {

/// A field over UVs or vertices that leaves wide Gaussians to a pyramid over space: what lies across a seam,
/// in another chart or of another material of the same medium counts where it lies in the world. Narrow
/// Gaussians, which resolve texels, are the field's own; from half the pyramid's finest variance to all of it
/// both are mixed: the field at the former and the pyramid at the latter, whatever lies between.
class SurfaceAlbedo final : public AlbedoField {
 public:
  /// One pyramid per material index; materials that share a medium share one. Null: the field alone answers.
  SurfaceAlbedo(const TriangleMesh& mesh, std::unique_ptr<AlbedoField> field,
                std::vector<std::shared_ptr<const SurfacePyramid>> pyramids);

  Rgb at(const SurfacePoint& point) const override { return field_->at(point); }
  Rgb filtered(const KernelFootprint& footprint) const override;
  Rgb max() const override { return field_->max(); }
  double by_position_from() const override { return by_position_from_; }

  const AlbedoField& field() const { return *field_; }
  const SurfacePyramid* pyramid(uint32_t triangle) const {
    return pyramids_[mesh_.materials[triangle]].get();
  }

 private:
  const TriangleMesh& mesh_;
  std::unique_ptr<AlbedoField> field_;
  std::vector<std::shared_ptr<const SurfacePyramid>> pyramids_;
  double by_position_from_ = 0;
};

/// The finest spread, m, at which a pyramid over these triangles is of use and takes up to about as much
/// memory as `texels` float RGBA texels: `texel_size` is what one measures on the surface, m (0: nothing to
/// resolve).
double finest_pyramid_sigma(const TriangleMesh& mesh, std::span<const uint32_t> triangles, double texel_size,
                            std::size_t texels);

/// The side of a texel on the surface, m: the root of the area per texel, over those triangles that have any
/// in the UV set; 0 where none has.
double texel_size(const TriangleMesh& mesh, const UvAtlas& atlas, std::span<const uint32_t> triangles,
                  const TextureMapping& mapping, int width, int height);

/// Whether UV is one affine map over these triangles, which lie in one plane: the texture's own pyramid is
/// exact there at every width.
bool is_affine(const TriangleMesh& mesh, const UvAtlas& atlas, std::span<const uint32_t> triangles);

}  // namespace alabaster
