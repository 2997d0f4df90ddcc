#include "texture/solid_texture.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "texture/noise.h"

namespace alabaster {

namespace {

constexpr double border = 2;  // texels beyond a chart that still get a value

/// Where a texel lies: on which triangle, and how far outside it (0: inside).
struct TexelOwner {
  uint32_t triangle = no_index;
  float outside = static_cast<float>(border);
};

/// A triangle in texel coordinates, with its map to space.
struct TexelTriangle {
  std::array<Vec2, 3> corner;  // texels
  Mat2 to_barycentric{0.0};
  bool degenerate = false;

  TexelTriangle(const TriangleMesh& mesh, uint32_t t, Vec2 size) {
    for (std::size_t k = 0; k < 3; ++k) corner[k] = Vec2(mesh.uv_sets[0][mesh.attributes[t][k]]) * size;
    const Mat2 edges(corner[1] - corner[0], corner[2] - corner[0]);
    degenerate = glm::determinant(edges) == 0;
    if (!degenerate) to_barycentric = glm::inverse(edges);
  }
  Vec2 barycentric(Vec2 texel) const { return to_barycentric * (texel - corner[0]); }
  bool contains(Vec2 texel) const {
    const Vec2 b = barycentric(texel);
    return b.x >= 0 && b.y >= 0 && b.x + b.y <= 1;
  }
  double distance(Vec2 texel) const {
    if (contains(texel)) return 0;
    double least = 1e30;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 a = corner[k], edge = corner[(k + 1) % 3] - a;
      const double t = std::clamp(glm::dot(texel - a, edge) / glm::dot(edge, edge), 0.0, 1.0);
      least = std::min(least, glm::length(texel - a - t * edge));
    }
    return least;
  }
};

void claim_texels(const TexelTriangle& triangle, uint32_t id, int width, int height,
                  std::vector<TexelOwner>& owners) {
  Vec2 low = glm::min(triangle.corner[0], glm::min(triangle.corner[1], triangle.corner[2])) - border;
  Vec2 high = glm::max(triangle.corner[0], glm::max(triangle.corner[1], triangle.corner[2])) + border;
  low = glm::max(glm::floor(low), Vec2(0));
  high = glm::min(glm::ceil(high), Vec2(width, height));
  for (int y = static_cast<int>(low.y); y < static_cast<int>(high.y); ++y)
    for (int x = static_cast<int>(low.x); x < static_cast<int>(high.x); ++x) {
      TexelOwner& owner =
          owners[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
      const auto outside = static_cast<float>(triangle.distance(Vec2(x + 0.5, y + 0.5)));
      if (outside < owner.outside) owner = {id, outside};
    }
}

}  // namespace

SolidPattern solid_stripes(const Vec3& axis, double period, const Tones& tones) {
  const Vec3 across = glm::normalize(axis) / period;
  return [=](const Vec3& p) {
    const double phase = glm::dot(across, p);
    return phase - std::floor(phase) < 0.5 ? tones.light : tones.dark;
  };
}

SolidPattern solid_checker(double side, const Tones& tones) {
  return [=](const Vec3& p) {
    const Vec3 cell = glm::floor(p / side);
    const double sum = cell.x + cell.y + cell.z;
    return sum - 2 * std::floor(sum / 2) == 0 ? tones.light : tones.dark;
  };
}

SolidPattern solid_stone(const StoneParameters& s) {
  return [s](const Vec3& p) {
    const Vec3 q = p / s.scale;
    const Vec3 wander{fractal_noise(q, 4, s.seed + 10), fractal_noise(q, 4, s.seed + 20),
                      fractal_noise(q, 4, s.seed + 30)};
    const double cloud = std::clamp(0.5 + 0.9 * fractal_noise(0.8 * q + 0.6 * wander, 5, s.seed), 0.0, 1.0);
    Rgb colour = (1 - cloud) * s.body + cloud * s.cloud;
    // Two families of veins, the second finer and fainter; each fades in and out along its way.
    for (int family = 0; family < 2; ++family) {
      const double frequency = family == 0 ? 0.7 : 1.9, width = s.vein_width * (family == 0 ? 1 : 0.8);
      const auto seed = s.seed + 100 + 10 * static_cast<uint64_t>(family);
      const double field = gradient_noise(frequency * (q + s.warp * wander), seed);
      const double presence =
          std::clamp(0.6 + 1.4 * fractal_noise(0.9 * q, 2, seed + 5), 0.0, 1.0) * (family == 0 ? 1 : 0.55);
      // Dark at the crack, with a stain around it.
      const double x = std::abs(field) / (width * frequency);
      const double vein = 0.7 * std::exp(-x * x) + 0.3 * std::exp(-0.5 * x);
      const double t = s.vein_strength * presence * vein;
      colour = (1 - t) * colour + t * s.vein;
    }
    return colour;
  };
}

TexelArray bake_solid(const TriangleMesh& mesh, int width, int height, const SolidPattern& pattern,
                      const Rgb& outside) {
  const Vec2 size(width, height);
  const auto texel_count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<TexelOwner> owners(texel_count);
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const TexelTriangle triangle(mesh, t, size);
    if (!triangle.degenerate) claim_texels(triangle, t, width, height, owners);
  }

  constexpr int points = 3;  // per texel and direction
  TexelArray texels{width, height,
                    std::vector<Vec4f>(texel_count, Vec4f(outside.r, outside.g, outside.b, 0))};
  parallel_for(texel_count, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (owners[k].triangle == no_index) continue;
      const TexelTriangle triangle(mesh, owners[k].triangle, size);
      const Vec2 texel(static_cast<double>(k % static_cast<std::size_t>(width)),
                       static_cast<double>(k / static_cast<std::size_t>(width)));
      Rgb sum;
      for (int n = 0; n < points * points; ++n)
        sum += pattern(mesh.position(
            owners[k].triangle,
            triangle.barycentric(texel + Vec2(n % points + 0.5, n / points + 0.5) / double{points})));
      sum /= points * points;
      texels.texels[k] = Vec4f(sum.r, sum.g, sum.b, 1);
    }
  });
  return texels;
}

}  // namespace alabaster
