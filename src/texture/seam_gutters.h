#pragma once

#include <span>

#include "geometry/mesh.h"
#include "texture/coverage.h"
#include "texture/texture.h"

namespace alabaster {

/// Fills the texels around charts with what the surface shows beyond the seam, so that a lookup near a seam
/// counts its true neighbours. A texel within `reach` texels of a seam's edge and outside all charts gets the
/// value at the place one comes to by going straight on over the seam, as far and as sloped as the texel lies
/// from the edge; its weight becomes 1. Texels nearer to another chart are that chart's; open borders, places
/// beyond which another material begins and neighbours without texels fill nothing. Values are averages of
/// covered texels. Returns how many were filled.
std::size_t fill_gutters(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                         const TextureMapping& mapping, TexelArray& texels, Coverage& coverage,
                         double reach = 16);

}  // namespace alabaster
