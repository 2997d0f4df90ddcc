// What each kind of pyramid makes of a Gaussian on a surface of several charts, against brute force over the
// mesh:
//   build/release/tests/test_bench "[aggregation]"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "core/frame.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "geometry/geodesic.h"
#include "geometry/shapes.h"
#include "texture/material_map.h"
#include "texture/seam_gutters.h"
#include "texture/solid_texture.h"
#include "texture/surface_albedo.h"

using namespace alabaster;

namespace {

constexpr int side = 1024;

struct Blob {
  TriangleMesh mesh = make_blob(1, 0.25, 96);
  UvAtlas atlas{mesh};
  HalfEdgeMesh half_edges{mesh};
  RayScene rays;
  std::vector<uint32_t> triangles = std::vector<uint32_t>(mesh.triangle_count());
  Coverage coverage;
  double texel = 0;

  Blob() {
    rays.add(mesh);
    rays.commit();
    std::iota(triangles.begin(), triangles.end(), 0u);
    coverage = texel_coverage(mesh, atlas, triangles, {}, side, side);
    texel = texel_size(mesh, atlas, triangles, {}, side, side);
  }
  KernelFootprint footprint(const SurfacePoint& p, double sigma) const {
    const Frame frame(p.geometric_normal);
    return {p.uv,
            p.barycentric,
            p.triangle,
            sigma,
            {atlas.uv_from_surface(p.triangle, frame.tangent),
             atlas.uv_from_surface(p.triangle, frame.bitangent)},
            p.position};
  }
};

/// The mean over the mesh, from about `count` points within 3.5 deviations of p.
double brute_force(const Blob& blob, const AlbedoField& field, const Geodesic& distance,
                   const SurfacePoint& p, double sigma, double count) {
  Rng rng(5);
  const double reach = 3.5 * sigma, density = count / std::min(pi * reach * reach, 12.0);
  double sum = 0, weight = 0;
  for (const uint32_t t : blob.triangles) {
    const double size = glm::distance(blob.mesh.position(t, {0, 0}), blob.mesh.position(t, {1, 0})) * 1.5;
    if (glm::distance(blob.mesh.position(t, Vec2(1.0 / 3)), p.position) > reach + size) continue;
    // Jittered in the cells of a square folded onto the triangle.
    const int n = static_cast<int>(std::ceil(std::sqrt(blob.mesh.area(t) * density)));
    for (int j = 0; j < n * n; ++j) {
      const double u = std::sqrt((j / n + rng.uniform()) / n), v = (j % n + rng.uniform()) / n;
      const SurfacePoint q = blob.mesh.surface_point(t, {u * (1 - v), u * v});
      if (glm::distance(q.position, p.position) > reach) continue;
      const auto d = distance.distance(p, q);
      if (!d) continue;
      const double w = blob.mesh.area(t) / (n * n) * std::exp(-0.5 * *d * *d / (sigma * sigma));
      sum += w * field.at(q).r, weight += w;
    }
  }
  return sum / weight;
}

double megabytes(std::size_t bytes) {
  return 1e-6 * static_cast<double>(bytes);
}

TexelArray padded(const TexelArray& texels, const Coverage& coverage) {
  const GaussianPyramid known(texels, coverage.weights, Wrap::repeat, Wrap::repeat);
  TexelArray result = texels;
  for (int y = 0, i = 0; y < side; ++y)
    for (int x = 0; x < side; ++x, ++i)
      if (!(coverage.weights[static_cast<std::size_t>(i)] > 0)) {
        const Rgb c = known.at(Vec2(x + 0.5, y + 0.5) / static_cast<double>(side));
        result.at(x, y) = Vec4f(c.r, c.g, c.b, 1);
      }
  return result;
}

}  // namespace

TEST_CASE("pyramids against brute force on a blob of six charts", "[.][bench][aggregation]") {
  const Blob blob;
  fmt::print("blob of {} triangles, {} charts, texels of {:.5f}\n", blob.mesh.triangle_count(),
             blob.atlas.chart_count(), blob.texel);
  const auto near = make_normal_corrected_chord(blob.mesh, blob.rays, 0);
  const auto far = make_straightest_path(blob.mesh, blob.half_edges);
  struct Pattern {
    const char* name;
    SolidPattern value;
  };
  const Tones tones{Rgb(0.95), Rgb(0.5)};
  for (const Pattern& pattern :
       {Pattern{"stripes, period 0.12", solid_stripes(Vec3(1, 0.3, 0.2), 0.12, tones)},
        Pattern{"cubes, side 0.4", solid_checker(0.4, tones)}}) {
    const TexelArray texels = bake_solid(blob.mesh, side, side, pattern.value, Rgb(0));
    double start = cpu_seconds();
    const TextureAlbedo weighted(blob.mesh, blob.triangles, texels, blob.coverage, {});
    const double uv_seconds = cpu_seconds() - start;
    Coverage all;
    all.weights.assign(texels.texels.size(), 1);
    const TextureAlbedo plain(blob.mesh, blob.triangles, texels, all, {});
    const TextureAlbedo pushed(blob.mesh, blob.triangles, padded(texels, blob.coverage), all, {});
    TexelArray gutters = texels;
    Coverage wider = blob.coverage;
    start = cpu_seconds();
    const std::size_t filled = fill_gutters(blob.mesh, blob.triangles, {}, gutters, wider);
    fmt::print("{} texels filled across seams in {:.2f} s\n", filled, cpu_seconds() - start);
    const TextureAlbedo aware(blob.mesh, blob.triangles, gutters, wider, {});
    start = cpu_seconds();
    const double finest = finest_pyramid_sigma(blob.mesh, blob.triangles, blob.texel, side * side);
    const auto space = std::make_shared<const SurfacePyramid>(blob.mesh, blob.triangles, weighted, finest);
    fmt::print(
        "{}: UV pyramid {:.2f} s, {:.1f} MB; in space {:.2f} s, {:.1f} MB, from sigma {:.4f} ({:.1f} "
        "texels), {} levels\n",
        pattern.name, uv_seconds, megabytes(weighted.pyramid().memory_bytes()), cpu_seconds() - start,
        megabytes(space->memory_bytes()), space->finest_sigma(), space->finest_sigma() / blob.texel,
        space->level_count());
    const SurfaceAlbedo both(
        blob.mesh,
        std::make_unique<TextureAlbedo>(blob.mesh, blob.triangles, gutters, wider, TextureMapping{}),
        {space});
    struct Way {
      const char* name;
      std::function<double(const KernelFootprint&)> value;
    };
    const std::vector<Way> ways{
        {"plain mip", [&](const auto& f) { return plain.filtered(f).r; }},
        {"padded", [&](const auto& f) { return pushed.filtered(f).r; }},
        {"weighted", [&](const auto& f) { return weighted.filtered(f).r; }},
        {"seam-aware", [&](const auto& f) { return aware.filtered(f).r; }},
        {"in space", [&](const auto& f) { return space->filtered(f.position, f.sigma).r; }},
        {"both", [&](const auto& f) { return both.filtered(f).r; }}};
    fmt::print("{:>8} {:>7}", "sigma", "texels");
    for (const Way& way : ways) fmt::print(" {:>16}", way.name);
    fmt::print("   (rms / worst, per cent of contrast; time per lookup, ns)\n");
    for (const double sigma : {blob.texel, 2 * blob.texel, 4 * blob.texel, 8 * blob.texel, 16 * blob.texel,
                               32 * blob.texel, 64 * blob.texel, 0.5}) {
      const bool wide = sigma > 0.1;
      Rng rng(8);
      std::vector<double> squared(ways.size()), worst(ways.size()), ns(ways.size());
      constexpr int count = 40;
      for (int n = 0; n < count; ++n) {
        const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(blob.mesh.triangle_count()));
        const SurfacePoint p = blob.mesh.surface_point(t, {0.3, 0.3});
        const double exact = brute_force(blob, weighted, wide ? *far : *near, p, sigma, wide ? 3000 : 20000);
        for (std::size_t w = 0; w < ways.size(); ++w) {
          const double error = std::abs(ways[w].value(blob.footprint(p, sigma)) - exact) / 0.45;
          squared[w] += error * error / count, worst[w] = std::max(worst[w], error);
        }
      }
      std::vector<KernelFootprint> many;
      for (int n = 0; n < 4000; ++n) {
        const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(blob.mesh.triangle_count()));
        many.push_back(blob.footprint(blob.mesh.surface_point(t, {0.3, 0.3}), sigma));
      }
      for (std::size_t w = 0; w < ways.size(); ++w) {
        double total = 0;
        const double begin = cpu_seconds();
        for (int round = 0; round < 10; ++round)
          for (const KernelFootprint& f : many) total += ways[w].value(f);
        ns[w] = 1e9 * (cpu_seconds() - begin) / 40000;
        CHECK(total > 0);
      }
      fmt::print("{:8.4f} {:7.1f}", sigma, sigma / blob.texel);
      for (std::size_t w = 0; w < ways.size(); ++w)
        fmt::print("  {:4.1f} /{:5.1f} {:4.0f}", 100 * std::sqrt(squared[w]), 100 * worst[w], ns[w]);
      fmt::print("\n");
    }
  }
}
