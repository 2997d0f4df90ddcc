#include "texture/seam_gutters.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "geometry/half_edge_mesh.h"
#include "geometry/surface_walk.h"
#include "geometry/triangle.h"
#include "geometry/uv_atlas.h"

namespace alabaster {

namespace {

/// One side of a seam: an edge of a chart and the triangle beyond it.
struct SeamSide {
  uint32_t triangle, beyond;
  uint8_t side;
};

/// The edge of a chart that is nearest to each texel.
struct Nearest {
  std::vector<float> distance;  // texels
  std::vector<uint32_t> side;
  std::vector<Vec2> place;  // of the texel's centre where the chart sees it, not wrapped
};

class GutterFiller {
 public:
  GutterFiller(const TriangleMesh& mesh, std::span<const uint32_t> triangles, const TextureMapping& mapping,
               const TexelArray& texels, const Coverage& coverage, double reach)
      : mesh_(mesh),
        mapping_(mapping),
        texels_(texels),
        coverage_(coverage),
        reach_(reach),
        size_(texels.width, texels.height),
        usable_(mesh.triangle_count(), false) {
    for (const uint32_t t : triangles) usable_[t] = true;
    for (const uint32_t t : coverage.untexeled) usable_[t] = false;
    for (const UvSeam& seam : find_uv_seams(mesh, mapping.uv_set)) {
      if (!usable_[seam.triangle] || !usable_[seam.other_triangle]) continue;
      sides_.push_back({seam.triangle, seam.other_triangle, seam.side});
      sides_.push_back({seam.other_triangle, seam.triangle, seam.other_side});
    }
  }

  bool has_seams() const { return !sides_.empty(); }

  Nearest nearest_sides() const {
    Nearest nearest;
    nearest.distance.assign(texels_.texels.size(), std::numeric_limits<float>::infinity());
    nearest.side.assign(texels_.texels.size(), no_index);
    nearest.place.resize(texels_.texels.size());
    for (uint32_t s = 0; s < sides_.size(); ++s) spread(s, nearest);
    return nearest;
  }

  void connect() { neighbours_ = triangle_neighbours(mesh_); }
  /// What the surface shows beyond the seam at that distance and slope.
  std::optional<Vec4f> beyond(const SeamSide& side, Vec2 place) const;
  const SeamSide& side(uint32_t s) const { return sides_[s]; }

 private:
  using Corners = std::array<Vec2, 3>;
  Corners in_texels(uint32_t triangle) const {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] =
          mapping_.transform(Vec2(mesh_.uv_sets[mapping_.uv_set][mesh_.attributes[triangle][k]])) * size_;
    return corners;
  }
  void spread(uint32_t index, Nearest& nearest) const;
  std::optional<std::size_t> texel_index(int x, int y) const {
    if (mapping_.wrap_u == Wrap::clamp && (x < 0 || x >= texels_.width)) return std::nullopt;
    if (mapping_.wrap_v == Wrap::clamp && (y < 0 || y >= texels_.height)) return std::nullopt;
    return static_cast<std::size_t>(wrap_index(y, texels_.height, mapping_.wrap_v)) *
               static_cast<std::size_t>(texels_.width) +
           static_cast<std::size_t>(wrap_index(x, texels_.width, mapping_.wrap_u));
  }
  std::optional<Vec4f> bilinear(Vec2 place) const;

  const TriangleMesh& mesh_;
  const TextureMapping& mapping_;
  const TexelArray& texels_;
  const Coverage& coverage_;
  double reach_;
  Vec2 size_;
  std::vector<bool> usable_;
  std::vector<SeamSide> sides_;
  std::vector<Index3> neighbours_;
};

double cross(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}

/// Claims the uncovered texels outside the edge for which it is the nearest so far.
void GutterFiller::spread(uint32_t index, Nearest& nearest) const {
  const SeamSide& side = sides_[index];
  const Corners corners = in_texels(side.triangle);
  const Vec2 a = corners[side.side], b = corners[(side.side + 1) % 3], c = corners[(side.side + 2) % 3];
  const Vec2 edge = b - a;
  const double squared = glm::dot(edge, edge), inside = cross(edge, c - a);
  const Vec2 low = glm::min(a, b) - reach_, high = glm::max(a, b) + reach_;
  const double area = (high.x - low.x) * (high.y - low.y);
  if (!(squared > 0) || !(std::abs(inside) > 0) || !(area < 4 * size_.x * size_.y + 4 * reach_ * reach_))
    return;
  for (int y = static_cast<int>(std::floor(low.y)); y <= static_cast<int>(high.y); ++y)
    for (int x = static_cast<int>(std::floor(low.x)); x <= static_cast<int>(high.x); ++x) {
      const Vec2 p(x + 0.5, y + 0.5);
      if (cross(edge, p - a) * inside > 0) continue;
      const double along = std::clamp(glm::dot(p - a, edge) / squared, 0.0, 1.0);
      const auto distance = static_cast<float>(glm::distance(p, a + along * edge));
      if (!(static_cast<double>(distance) <= reach_)) continue;
      const auto texel = texel_index(x, y);
      if (!texel || coverage_.weights[*texel] > 0 || !(distance < nearest.distance[*texel])) continue;
      nearest.distance[*texel] = distance;
      nearest.side[*texel] = index;
      nearest.place[*texel] = p;
    }
}

std::optional<Vec4f> GutterFiller::beyond(const SeamSide& side, Vec2 place) const {
  const Corners c = in_texels(side.triangle);
  const double area = cross(c[1] - c[0], c[2] - c[0]);
  const Vec2 b(cross(place - c[0], c[2] - c[0]) / area, cross(c[1] - c[0], place - c[0]) / area);
  // The texel in the chart's plane, continued beyond the edge; then the same from the edge on, but over the
  // neighbour.
  const Vec3 wanted = mesh_.position(side.triangle, b);
  const Index3& own = mesh_.corners[side.triangle];
  const uint32_t from = own[side.side], to = own[(side.side + 1) % 3];
  const Vec3 start = mesh_.positions[from], whole = mesh_.positions[to] - start;
  const double length = glm::length(whole);
  const Vec3 edge = whole / length, offset = wanted - start;
  const double along = glm::dot(offset, edge), out = glm::length(offset - along * edge);
  const double foot = std::clamp(along, 0.0, length);
  Vec3 opposite(0);
  for (const uint32_t corner : mesh_.corners[side.beyond])
    if (corner != from && corner != to) opposite = mesh_.positions[corner] - start;
  const Vec3 into = glm::normalize(opposite - edge * glm::dot(edge, opposite));
  const Vec3 way = (along - foot) * edge + out * into;
  const double distance = glm::length(way);
  if (!std::isfinite(distance)) return std::nullopt;
  SurfaceWalker walker{side.beyond, start + foot * edge, into, 0};
  if (distance > 0) {
    walker.direction = way / distance;
    const auto across = [this](uint32_t t, int k) { return neighbours_[t][static_cast<std::size_t>(k)]; };
    walker = walk_straight(mesh_, across, walker, distance);
  }
  if (!usable_[walker.triangle] || walker.walked < 0.999 * distance) return std::nullopt;
  const Index3& i = mesh_.corners[walker.triangle];
  const Triangle triangle{mesh_.positions[i[0]], mesh_.positions[i[1]], mesh_.positions[i[2]]};
  const Vec2 uv = mesh_.uv(walker.triangle, triangle.closest(walker.position), mapping_.uv_set);
  return bilinear(mapping_.transform(uv) * size_);
}

/// The mean of the covered ones among the four texels around a place.
std::optional<Vec4f> GutterFiller::bilinear(Vec2 place) const {
  const Vec2 corner = glm::floor(place - 0.5), f = place - 0.5 - corner;
  if (!(std::abs(corner.x) + std::abs(corner.y) < 1e9)) return std::nullopt;
  Vec4 sum(0);
  double weight = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const auto texel = texel_index(static_cast<int>(corner.x) + i, static_cast<int>(corner.y) + j);
      if (!texel) continue;
      const double w = (i == 0 ? 1 - f.x : f.x) * (j == 0 ? 1 - f.y : f.y) *
                       static_cast<double>(coverage_.weights[*texel]);
      sum += w * Vec4(texels_.texels[*texel]);
      weight += w;
    }
  if (!(weight > 1e-3)) return std::nullopt;
  return Vec4f(sum / weight);
}

}  // namespace

std::size_t fill_gutters(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                         const TextureMapping& mapping, TexelArray& texels, Coverage& coverage,
                         double reach) {
  GutterFiller filler(mesh, triangles, mapping, texels, coverage, reach);
  if (!filler.has_seams()) return 0;
  const Nearest nearest = filler.nearest_sides();
  filler.connect();
  std::vector<uint32_t> wanted;
  for (uint32_t i = 0; i < nearest.side.size(); ++i)
    if (nearest.side[i] != no_index) wanted.push_back(i);
  std::vector<std::optional<Vec4f>> values(wanted.size());
  parallel_for(wanted.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      values[k] = filler.beyond(filler.side(nearest.side[wanted[k]]), nearest.place[wanted[k]]);
  });
  std::size_t filled = 0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (!values[k]) continue;
    texels.texels[wanted[k]] = *values[k];
    coverage.weights[wanted[k]] = 1;
    ++filled;
  }
  return filled;
}

}  // namespace alabaster
