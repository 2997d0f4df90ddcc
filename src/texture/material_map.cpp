#include "texture/material_map.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>

#include "core/parallel.h"
#include "core/rng.h"

namespace alabaster {

namespace {

// Remembers the albedos of reflectances met before: pictures of 8 bits have few different ones.
class AlbedoCache {
 public:
  AlbedoCache(const ReflectanceToAlbedo& to_albedo, int channel) : to_albedo_(to_albedo), channel_(channel) {}
  float operator()(float reflectance) {
    const auto key = std::bit_cast<uint32_t>(reflectance);
    Entry& entry = entries_[mix_bits(key) % entries_.size()];
    if (!entry.valid || entry.key != key)
      entry = {key, static_cast<float>(to_albedo_(static_cast<double>(reflectance), channel_)), true};
    return entry.albedo;
  }

 private:
  struct Entry {
    uint32_t key = 0;
    float albedo = 0;
    bool valid = false;
  };
  const ReflectanceToAlbedo& to_albedo_;
  int channel_;
  std::array<Entry, 1024> entries_{};
};

// The linear map between two UV sets on one triangle; zero where the first has no area.
Mat2 between_uv_sets(const TriangleMesh& mesh, uint32_t triangle, std::size_t to) {
  const auto edges = [&](std::size_t set) {
    const Vec2 a = mesh.uv(triangle, {0, 0}, set);
    return Mat2(mesh.uv(triangle, {1, 0}, set) - a, mesh.uv(triangle, {0, 1}, set) - a);
  };
  const Mat2 from = edges(0);
  const double area = glm::determinant(from);
  return area != 0 ? edges(to) * glm::inverse(from) : Mat2(0.0);
}

}  // namespace

AlbedoTexels albedo_texels(const TexelArray& reflectance, const Rgb& factor, std::span<const float> weights,
                           const ReflectanceToAlbedo& to_albedo, double largest) {
  assert(weights.empty() || weights.size() == reflectance.texels.size());
  AlbedoTexels result;
  result.texels = {reflectance.width, reflectance.height,
                   std::vector<Vec4f>(reflectance.texels.size(), Vec4f(0, 0, 0, 1))};
  std::atomic<std::size_t> clamped = 0;
  parallel_for(reflectance.texels.size(), 16384, [&](std::size_t begin, std::size_t end) {
    std::size_t clamped_here = 0;
    std::array<AlbedoCache, 3> albedo{AlbedoCache(to_albedo, 0), {to_albedo, 1}, {to_albedo, 2}};
    for (std::size_t i = begin; i < end; ++i) {
      if (!weights.empty() && !(weights[i] > 0)) continue;
      bool above = false;
      for (int c = 0; c < 3; ++c) {
        const double wanted = static_cast<double>(reflectance.texels[i][c]) * factor[c];
        above = above || wanted > largest;
        result.texels.texels[i][c] = albedo[static_cast<std::size_t>(c)](
            static_cast<float>(wanted > 0 ? std::min(wanted, largest) : 0));
      }
      clamped_here += above ? 1 : 0;
    }
    clamped += clamped_here;
  });
  result.clamped = clamped;
  return result;
}

double bake_vertex_colours(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                           const TextureMapping& mapping, TexelArray& texels) {
  struct Sum {
    Vec3 colour{0}, low{1e30}, high{-1e30};
    int count = 0;
  };
  std::vector<Sum> sums(texels.texels.size());
  for_each_covered_texel(mesh, triangles, mapping, texels.width, texels.height,
                         [&](std::size_t texel, uint32_t triangle, Vec2 b) {
                           const Index3& c = mesh.attributes[triangle];
                           const Vec3 colour((1 - b.x - b.y) * Vec4(mesh.colours[c[0]]) +
                                             b.x * Vec4(mesh.colours[c[1]]) + b.y * Vec4(mesh.colours[c[2]]));
                           Sum& sum = sums[texel];
                           sum.colour += colour;
                           sum.low = glm::min(sum.low, colour);
                           sum.high = glm::max(sum.high, colour);
                           ++sum.count;
                         });
  std::size_t covered = 0, disputed = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const Sum& sum = sums[i];
    if (sum.count == 0) continue;
    ++covered;
    const Vec3 spread = sum.high - sum.low;
    if (std::max({spread.x, spread.y, spread.z}) > 0.02) ++disputed;
    const Vec3 mean = sum.colour / static_cast<double>(sum.count);
    texels.texels[i] *= Vec4f(Vec4(mean, 1));
  }
  return covered > 0 ? static_cast<double>(disputed) / static_cast<double>(covered) : 0;
}

TextureAlbedo::TextureAlbedo(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                             const TexelArray& albedo, const Coverage& coverage,
                             const TextureMapping& mapping)
    : mesh_(mesh),
      mapping_(mapping),
      st_from_uv_(mapping.linear_part()),
      pyramid_(albedo, coverage.weights, mapping.wrap_u, mapping.wrap_v, mapping.filter),
      substitutes_(substitute_uvs(mesh, triangles, coverage.untexeled, mapping.uv_set)) {}

Vec2 TextureAlbedo::texture_point(uint32_t triangle, Vec2 uv, Vec2 barycentric) const {
  if (mapping_.uv_set != 0) uv = mesh_.uv(triangle, barycentric, mapping_.uv_set);
  if (!substitutes_.empty())
    if (const auto found = substitutes_.find(triangle); found != substitutes_.end()) uv = found->second;
  return mapping_.offset + st_from_uv_ * uv;
}

Rgb TextureAlbedo::at(const SurfacePoint& point) const {
  return pyramid_.at(texture_point(point.triangle, point.uv, point.barycentric));
}

Rgb TextureAlbedo::filtered(const KernelFootprint& footprint) const {
  const Vec2 st = texture_point(footprint.triangle, footprint.uv, footprint.barycentric);
  Mat2 uv_from_surface = footprint.uv_from_surface;
  if (mapping_.uv_set != 0)
    uv_from_surface = between_uv_sets(mesh_, footprint.triangle, mapping_.uv_set) * uv_from_surface;
  const Mat2 texels_from_st(pyramid_.width(), 0, 0, pyramid_.height());
  const Mat2 spread = footprint.sigma * (texels_from_st * (st_from_uv_ * uv_from_surface));
  const Mat2 covariance = spread * glm::transpose(spread);
  const double trace = covariance[0][0] + covariance[1][1], determinant = glm::determinant(covariance);
  // A footprint stretched by less than 1.06 : 1 counts as round: one lookup instead of several.
  if (determinant >= 0.24915 * trace * trace) return pyramid_.filtered(st, std::sqrt(0.5 * trace));
  return pyramid_.filtered(st, covariance);
}

ObjectAlbedo::ObjectAlbedo(const TriangleMesh& mesh, std::vector<std::unique_ptr<AlbedoField>> fields)
    : mesh_(mesh), fields_(std::move(fields)) {
  for (const auto& field : fields_)
    if (field)
      for (int c = 0; c < 3; ++c) max_[c] = std::max(max_[c], field->max()[c]);
}

const AlbedoField* ObjectAlbedo::field(uint32_t triangle) const {
  const std::size_t material = mesh_.materials[triangle];
  return material < fields_.size() ? fields_[material].get() : nullptr;
}

Rgb ObjectAlbedo::at(const SurfacePoint& point) const {
  const AlbedoField* found = field(point.triangle);
  return found != nullptr ? found->at(point) : Rgb(0);
}

Rgb ObjectAlbedo::filtered(const KernelFootprint& footprint) const {
  const AlbedoField* found = field(footprint.triangle);
  return found != nullptr ? found->filtered(footprint) : Rgb(0);
}

}  // namespace alabaster
