#pragma once

#include <functional>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/uv_atlas.h"
#include "texture/albedo_field.h"
#include "texture/coverage.h"
#include "texture/gaussian_pyramid.h"
#include "texture/texture.h"

namespace alabaster {

/// Single-scattering albedo that shows a wanted reflectance, for one channel (0, 1, 2). Called from many
/// threads; slow ones are fine, values are remembered.
using ReflectanceToAlbedo = std::function<double(double reflectance, int channel)>;

struct AlbedoTexels {
  TexelArray texels;        // rgb alpha, a 1
  std::size_t clamped = 0;  // covered texels with a channel above the largest reflectance
};

/// alpha of reflectance x factor, texel by texel, in float, before any filtering (docs/theory.md).
/// Reflectances are clamped to [0, largest]; NaN becomes 0. Texels of zero weight are left 0 (`weights`
/// empty: all count).
AlbedoTexels albedo_texels(const TexelArray& reflectance, const Rgb& factor, std::span<const float> weights,
                           const ReflectanceToAlbedo& to_albedo, double largest = 0.98);

/// Multiplies every covered texel by the mesh's colour (COLOR_0) there. Where triangles share texels it takes
/// the mean of their colours. Returns the share of covered texels whose triangles disagree by more than 0.02.
double bake_vertex_colours(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                           const TextureMapping& mapping, TexelArray& texels);

/// One albedo everywhere.
class ConstantAlbedo : public AlbedoField {
 public:
  explicit ConstantAlbedo(const Rgb& albedo) : albedo_(albedo) {}
  Rgb at(const SurfacePoint&) const override { return albedo_; }
  Rgb filtered(const KernelFootprint&) const override { return albedo_; }
  Rgb max() const override { return albedo_; }

 private:
  Rgb albedo_;
};

/// Albedo from a texture through a coverage-weighted pyramid. Honours the mapping: transform, wrap, filter at
/// the finest level, and the UV set (footprints speak of set 0; another set's are derived from the triangle).
/// The mesh must outlive it.
class TextureAlbedo : public AlbedoField {
 public:
  /// `albedo` holds alpha, not reflectance. `triangles` are those that wear this texture, `coverage` theirs.
  TextureAlbedo(const TriangleMesh& mesh, std::span<const uint32_t> triangles, const TexelArray& albedo,
                const Coverage& coverage, const TextureMapping& mapping);

  Rgb at(const SurfacePoint& point) const override;
  Rgb filtered(const KernelFootprint& footprint) const override;
  Rgb max() const override { return pyramid_.max(); }
  const GaussianPyramid& pyramid() const { return pyramid_; }

 private:
  Vec2 texture_point(uint32_t triangle, Vec2 uv, Vec2 barycentric) const;

  const TriangleMesh& mesh_;
  TextureMapping mapping_;
  Mat2 st_from_uv_;  // linear part of the mapping's transform
  GaussianPyramid pyramid_;
  std::unordered_map<uint32_t, Vec2> substitutes_;  // triangle -> UV, for those that own no texel
};

/// An object with several materials: every lookup goes to the field of its triangle's material. A Gaussian
/// that reaches over the border of a material sees the side of its mean only.
class ObjectAlbedo : public AlbedoField {
 public:
  /// `fields` by material index; null where a material has no medium (albedo 0). The mesh must outlive it.
  ObjectAlbedo(const TriangleMesh& mesh, std::vector<std::unique_ptr<AlbedoField>> fields);

  Rgb at(const SurfacePoint& point) const override;
  Rgb filtered(const KernelFootprint& footprint) const override;
  Rgb max() const override { return max_; }

 private:
  const AlbedoField* field(uint32_t triangle) const;

  const TriangleMesh& mesh_;
  std::vector<std::unique_ptr<AlbedoField>> fields_;
  Rgb max_{0};
};

}  // namespace alabaster
