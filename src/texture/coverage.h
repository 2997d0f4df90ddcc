#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/uv_atlas.h"
#include "texture/texture.h"

namespace alabaster {

/// Which texels of a texture a mesh shows.
struct Coverage {
  std::vector<float> weights;       // width * height values, row 0 at the top
  std::vector<uint32_t> untexeled;  // triangles that own no texel; see substitute_uvs()
};

/// A texel's weight is 1 where its centre lies in one of the triangles (on an edge counts as inside), else 0.
/// Centres decide, not areas, because that is what the programs that paint atlases go by: a texel only grazed
/// by a chart often holds the background.
///
/// A chart may be so small that it contains no centre. If its texel density is like the rest of the mesh's
/// (at least 1/8 of the area-weighted mean), it is a splinter of an atlas, which nobody painted: its
/// triangles are listed in `untexeled`. If its density is far lower, it is meant: triangles shrunk onto a
/// spot of a palette. Then every texel it touches gets the area of the intersection, at least 0.001.
///
/// Tiled and mirrored UVs are wrapped; with clamp, what lies outside counts for the edge texels. Triangles
/// with corners that are not finite or that span more than 4096 tiles are untexeled. `atlas` is that of the
/// mapping's UV set.
Coverage texel_coverage(const TriangleMesh& mesh, const UvAtlas& atlas, std::span<const uint32_t> triangles,
                        const TextureMapping& mapping, int width, int height);

/// For every triangle of `untexeled` a UV on the nearest triangle of `triangles`, over shared corners, that
/// does own texels: its point closest to the middle. Its own where there is none.
std::unordered_map<uint32_t, Vec2> substitute_uvs(const TriangleMesh& mesh,
                                                  std::span<const uint32_t> triangles,
                                                  std::span<const uint32_t> untexeled, std::size_t uv_set);

/// Calls visit(texel index, triangle, barycentric) for every texel centre inside a triangle, once per
/// triangle that covers it (and once per tile).
void for_each_covered_texel(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                            const TextureMapping& mapping, int width, int height,
                            const std::function<void(std::size_t, uint32_t, Vec2)>& visit);

}  // namespace alabaster
