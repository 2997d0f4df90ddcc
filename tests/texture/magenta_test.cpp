// Models whose atlases are pure magenta outside the charts: whatever an albedo field is asked, no magenta may
// show. Wanted reflectance is turned into albedo by the identity here, so that colours stay recognisable.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>

#include "core/frame.h"
#include "core/rng.h"
#include "scene/scene_file.h"
#include "support/paths.h"
#include "texture/material_map.h"
#include "texture/seam_gutters.h"
#include "texture/surface_albedo.h"

using namespace alabaster;

namespace {

// How far green falls below what the charts hold at least; 0 when the colour could be one of theirs.
struct GreenRange {
  double low = 1, high = 0;
};

GreenRange green_range(const TexelArray& texels, const Coverage& coverage) {
  GreenRange range;
  for (std::size_t i = 0; i < texels.texels.size(); ++i) {
    if (coverage.weights[i] < 1) continue;
    range.low = std::min(range.low, static_cast<double>(texels.texels[i].y));
    range.high = std::max(range.high, static_cast<double>(texels.texels[i].y));
  }
  return range;
}

/// With gutters filled and the pyramid over space.
SurfaceAlbedo as_in_scenes(const TriangleMesh& mesh, const UvAtlas& atlas,
                           const std::vector<uint32_t>& triangles, TexelArray texels, Coverage coverage,
                           const TextureMapping& mapping) {
  fill_gutters(mesh, triangles, mapping, texels, coverage);
  auto field = std::make_unique<TextureAlbedo>(mesh, triangles, texels, coverage, mapping);
  const double size = texel_size(mesh, atlas, triangles, mapping, texels.width, texels.height);
  const double finest = finest_pyramid_sigma(mesh, triangles, size, texels.texels.size());
  std::vector<std::shared_ptr<const SurfacePyramid>> pyramids(
      std::size_t{*std::max_element(mesh.materials.begin(), mesh.materials.end())} + 1,
      std::make_shared<const SurfacePyramid>(mesh, triangles, *field, finest));
  return {mesh, std::move(field), std::move(pyramids)};
}

}  // namespace

TEST_CASE("the magenta outside the charts of real atlases never shows") {
  const auto extra = extra_dir();
  if (!extra) {
    std::puts("SKIPPED: set ALABASTER_EXTRA to the folder with assets/nefertiti.glb and assets/spot.glb");
    return;
  }
  for (const char* name : {"nefertiti.glb", "spot.glb"}) {
    LoadedScene loaded = load_scene(*extra / "assets" / name, {});
    const SceneObject& object = loaded.scene.objects.at(0);
    const TriangleMesh& mesh = object.mesh;
    const Material& material = loaded.scene.materials[mesh.materials[0]];
    REQUIRE(material.base_colour);
    const TexelArray& texels = material.base_colour->texels();
    const TextureMapping& mapping = material.base_colour->mapping();
    std::vector<uint32_t> triangles(mesh.triangle_count());
    for (uint32_t t = 0; t < triangles.size(); ++t) triangles[t] = t;
    const Coverage coverage =
        texel_coverage(mesh, object.atlas, triangles, mapping, texels.width, texels.height);
    const GreenRange range = green_range(texels, coverage);
    REQUIRE(range.low > 0.05);  // magenta has none
    const TextureAlbedo field(mesh, triangles, texels, coverage, mapping);
    const SurfaceAlbedo chosen = as_in_scenes(mesh, object.atlas, triangles, texels, coverage, mapping);

    Rng rng(1);
    for (int n = 0; n < 200000; ++n) {
      const auto triangle = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
      const double u = std::sqrt(rng.uniform()), v = rng.uniform();
      const SurfacePoint point = mesh.surface_point(triangle, {u * (1 - v), u * v});
      const Frame frame(point.geometric_normal);
      KernelFootprint footprint{point.uv, point.barycentric, triangle, 0.1 * std::exp(-10 * rng.uniform()),
                                {},       point.position};
      footprint.uv_from_surface = {object.atlas.uv_from_surface(triangle, frame.tangent),
                                   object.atlas.uv_from_surface(triangle, frame.bitangent)};
      for (const Rgb& colour :
           {field.at(point), field.filtered(footprint), chosen.at(point), chosen.filtered(footprint)}) {
        INFO(name << ", triangle " << triangle << ", sigma " << footprint.sigma);
        REQUIRE(colour.g > range.low - 1e-5);
        REQUIRE(colour.g < range.high + 1e-5);
      }
    }
    std::printf("%s: %zu of %zu triangles own no texel\n", name, coverage.untexeled.size(), triangles.size());
  }
}
