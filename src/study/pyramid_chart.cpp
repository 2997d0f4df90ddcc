#include "study/pyramid_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
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

namespace alabaster {

namespace {

constexpr double bright = 0.95, dark = 0.5;
constexpr double widest = 0.5;  // a quarter of the object
// Geodesic distances: straightest paths for wide Gaussians, corrected chords, which are as good there, for
// narrow ones.
constexpr double by_path_from = 0.1;

struct Blob {
  TriangleMesh mesh;
  UvAtlas atlas;
  HalfEdgeMesh half_edges;
  RayScene rays;
  std::vector<uint32_t> triangles;
  Coverage coverage;
  int side;
  double texel;  // its side on the surface
  std::unique_ptr<GeodesicPath> near, far;

  explicit Blob(int texture_side)
      : mesh(make_blob(1, 0.25, std::clamp(texture_side / 10, 24, 96))),
        atlas(mesh),
        half_edges(mesh),
        triangles(mesh.triangle_count()),
        side(texture_side) {
    rays.add(mesh);
    rays.commit();
    std::iota(triangles.begin(), triangles.end(), 0u);
    coverage = texel_coverage(mesh, atlas, triangles, {}, side, side);
    texel = texel_size(mesh, atlas, triangles, {}, side, side);
    near = make_normal_corrected_chord(mesh, rays, 0);
    far = make_straightest_path(mesh, half_edges);
  }
  SurfacePoint random_point(Rng& rng) const {
    const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
    const double u = std::sqrt(rng.uniform()), v = rng.uniform();
    return mesh.surface_point(t, {u * (1 - v), u * v});
  }
  KernelFootprint footprint(const SurfacePoint& p, double sigma) const {
    const Frame frame(p.geometric_normal);
    const Mat2 jacobian{atlas.uv_from_surface(p.triangle, frame.tangent),
                        atlas.uv_from_surface(p.triangle, frame.bitangent)};
    return {p.uv, p.barycentric, p.triangle, sigma, jacobian, p.position};
  }
  double distance(const SurfacePoint& a, const SurfacePoint& b, double sigma) const {
    if (sigma > by_path_from)
      if (const auto path = far->distance(a, b)) return *path;
    return near->distance(a, b).value_or(glm::distance(a.position, b.position));
  }
};

/// The mean over the mesh by about `count` points within 3.5 deviations, in two halves.
std::array<double, 2> brute_force(const Blob& blob, const AlbedoField& field, const SurfacePoint& p,
                                  double sigma, double count, uint64_t seed) {
  Rng rng(seed);
  const double reach = 3.5 * sigma, density = 0.5 * count / std::min(pi * reach * reach, 12.0);
  double sum[2]{}, weight[2]{};
  for (const uint32_t t : blob.triangles) {
    const double size = glm::distance(blob.mesh.position(t, {0, 0}), blob.mesh.position(t, {1, 0})) * 1.5;
    if (glm::distance(blob.mesh.position(t, Vec2(1.0 / 3)), p.position) > reach + size) continue;
    // Jittered in the cells of a square folded onto the triangle.
    const int n = static_cast<int>(std::ceil(std::sqrt(blob.mesh.area(t) * density)));
    for (int j = 0; j < 2 * n * n; ++j) {
      const double u = std::sqrt((j / 2 / n + rng.uniform()) / n), v = (j / 2 % n + rng.uniform()) / n;
      const SurfacePoint q = blob.mesh.surface_point(t, {u * (1 - v), u * v});
      if (glm::distance(q.position, p.position) > reach) continue;
      const double d = blob.distance(p, q, sigma);
      const double w = blob.mesh.area(t) / (n * n) * std::exp(-0.5 * d * d / (sigma * sigma));
      sum[j % 2] += w * field.at(q).r, weight[j % 2] += w;
    }
  }
  return {sum[0] / weight[0], sum[1] / weight[1]};
}

/// Texels outside the charts take the nearest average of covered ones.
TexelArray padded(const TexelArray& texels, const Coverage& coverage) {
  const GaussianPyramid known(texels, coverage.weights, Wrap::repeat, Wrap::repeat);
  TexelArray result = texels;
  for (int y = 0, i = 0; y < texels.height; ++y)
    for (int x = 0; x < texels.width; ++x, ++i)
      if (!(coverage.weights[static_cast<std::size_t>(i)] > 0)) {
        const Rgb c = known.at(Vec2(x + 0.5, y + 0.5) / Vec2(texels.width, texels.height));
        result.at(x, y) = Vec4f(c.r, c.g, c.b, 1);
      }
  return result;
}

struct Method {
  std::string name;
  std::function<Rgb(const KernelFootprint&)> value;
};

/// Every way to average one picture.
class Fields {
 public:
  Fields(const Blob& blob, const TexelArray& texels, PyramidMeasurements& result) {
    const Coverage all{std::vector<float>(texels.texels.size(), 1.0f), {}};
    const auto field = [&](const TexelArray& picture, const Coverage& coverage) {
      return std::make_unique<TextureAlbedo>(blob.mesh, blob.triangles, picture, coverage, TextureMapping{});
    };
    result.costs.clear();
    double start = cpu_seconds();
    const auto done = [&](const char* name, std::size_t bytes) {
      result.costs.push_back({name, static_cast<double>(bytes) / static_cast<double>(texels.texels.size()),
                              cpu_seconds() - start});
      start = cpu_seconds();
    };
    plain_ = field(texels, all);
    done("plain mip", plain_->pyramid().memory_bytes());
    padded_ = field(padded(texels, blob.coverage), all);
    done("padded", padded_->pyramid().memory_bytes());
    weighted_ = field(texels, blob.coverage);
    done("coverage-weighted", weighted_->pyramid().memory_bytes());
    TexelArray filled = texels;
    Coverage wider = blob.coverage;
    result.filled_texels = fill_gutters(blob.mesh, blob.triangles, {}, filled, wider);
    auto aware = field(filled, wider);
    aware_ = aware.get();
    done("seam-aware", aware_->pyramid().memory_bytes());
    const double finest = finest_pyramid_sigma(blob.mesh, blob.triangles, blob.texel, texels.texels.size());
    space_ = std::make_shared<const SurfacePyramid>(blob.mesh, blob.triangles, *aware, finest);
    done("in space", space_->memory_bytes());
    result.space_from = space_->finest_sigma() / blob.texel;
    chosen_ = std::make_unique<SurfaceAlbedo>(blob.mesh, std::move(aware),
                                              std::vector<std::shared_ptr<const SurfacePyramid>>{space_});
    const PyramidCost &uv = result.costs[3], &space = result.costs[4];
    result.costs.push_back(
        {"chosen", uv.bytes_per_texel + space.bytes_per_texel, uv.build_seconds + space.build_seconds});
  }

  std::vector<Method> methods() const {
    return {{"plain mip", [this](const auto& f) { return plain_->filtered(f); }},
            {"padded", [this](const auto& f) { return padded_->filtered(f); }},
            {"coverage-weighted", [this](const auto& f) { return weighted_->filtered(f); }},
            {"seam-aware", [this](const auto& f) { return aware_->filtered(f); }},
            {"in space", [this](const auto& f) { return space_->filtered(f.position, f.sigma); }},
            {"chosen", [this](const auto& f) { return chosen_->filtered(f); }}};
  }
  const AlbedoField& truth() const { return *weighted_; }

 private:
  std::unique_ptr<TextureAlbedo> plain_, padded_, weighted_;
  const TextureAlbedo* aware_ = nullptr;  // owned by chosen_
  std::shared_ptr<const SurfacePyramid> space_;
  std::unique_ptr<SurfaceAlbedo> chosen_;
};

double nanoseconds(const Method& method, const std::vector<KernelFootprint>& footprints) {
  double total = 0;
  int rounds = 0;
  const double start = cpu_seconds();
  for (double passed = 0; passed < 0.02; ++rounds, passed = cpu_seconds() - start)
    for (const KernelFootprint& f : footprints) total += method.value(f).r;
  const double each = (cpu_seconds() - start) / rounds / static_cast<double>(footprints.size());
  return total > 0 ? 1e9 * each : 0;
}

void measure_width(const Blob& blob, const std::string& pattern, const Fields& fields, double sigma,
                   const PyramidChartOptions& options, PyramidMeasurements& result) {
  const auto count = static_cast<std::size_t>(options.places);
  std::vector<SurfacePoint> places;
  Rng rng(options.seed);
  for (std::size_t n = 0; n < count; ++n) places.push_back(blob.random_point(rng));
  std::vector<std::array<double, 2>> truth(count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      truth[n] =
          brute_force(blob, fields.truth(), places[n], sigma, options.points, hash_combine(options.seed, n));
  });
  std::vector<KernelFootprint> many;
  for (int n = 0; n < 4000; ++n) many.push_back(blob.footprint(blob.random_point(rng), sigma));
  double noise = 0;
  for (const auto& [a, b] : truth) noise += 0.25 * (a - b) * (a - b) / static_cast<double>(count);
  result.truth_noise.push_back(std::sqrt(noise) / (bright - dark));
  for (const Method& method : fields.methods()) {
    PyramidRow row{pattern, method.name, sigma, sigma / blob.texel};
    for (std::size_t n = 0; n < count; ++n) {
      const double exact = 0.5 * (truth[n][0] + truth[n][1]);
      const double error =
          std::abs(method.value(blob.footprint(places[n], sigma)).r - exact) / (bright - dark);
      row.rms += error * error / static_cast<double>(count);
      row.worst = std::max(row.worst, error);
    }
    row.rms = std::sqrt(row.rms);
    row.nanoseconds = nanoseconds(method, many);
    result.rows.push_back(row);
  }
}

}  // namespace

PyramidMeasurements measure_pyramids(const PyramidChartOptions& options) {
  const Blob blob(options.side);
  PyramidMeasurements result;
  result.side = options.side;
  result.triangles = blob.mesh.triangle_count();
  result.charts = blob.atlas.chart_count();
  const Tones tones{Rgb(bright), Rgb(dark)};
  const std::pair<const char*, SolidPattern> patterns[] = {
      {"stripes", solid_stripes(Vec3(1, 0.3, 0.2), 0.12, tones)}, {"cubes", solid_checker(0.4, tones)}};
  for (const auto& [name, pattern] : patterns) {
    const Fields fields(blob, bake_solid(blob.mesh, options.side, options.side, pattern, Rgb(0)), result);
    for (double sigma = blob.texel; sigma < 0.8 * widest; sigma *= std::sqrt(2.0))
      measure_width(blob, name, fields, sigma, options, result);
    measure_width(blob, name, fields, widest, options, result);
  }
  return result;
}

}  // namespace alabaster
