#include "geometry/uv_atlas.h"

#include <algorithm>
#include <cmath>

#include "geometry/mesh_edges.h"

namespace alabaster {

namespace {

bool is_finite(Vec2f uv) {
  return std::isfinite(uv.x) && std::isfinite(uv.y);
}

using UvTriangle = std::array<Vec2, 3>;

double twice_signed_area(const UvTriangle& t) {
  const Vec2 d1 = t[1] - t[0], d2 = t[2] - t[0];
  return d1.x * d2.y - d1.y * d2.x;
}

/// Counts how often each texel centre of a tile is covered, up to 2. Neighbouring triangles do not both
/// cover a centre on their common edge.
class CoverageRaster {
 public:
  static constexpr int size = 512;

  CoverageRaster() : counts_(std::size_t{size} * size, 0) {}

  void add(const UvTriangle& uv) {
    UvTriangle t;
    const Vec2 base = glm::floor(glm::min(uv[0], glm::min(uv[1], uv[2])));
    for (std::size_t k = 0; k < 3; ++k)
      t[k] = (uv[k] - base) * double{size} - 0.5;  // texel centres at integers
    const auto [low, high] = std::minmax({t[0].y, t[1].y, t[2].y});
    // Whoever spans more than three tiles covers everything more than once already.
    const int last = static_cast<int>(std::min(std::ceil(high), 3.0 * size));
    for (int y = static_cast<int>(std::ceil(low)); y < last && work_ < work_limit; ++y) add_row(t, y);
  }

  double overlap_fraction() const {
    const auto covered = std::count_if(counts_.begin(), counts_.end(), [](uint8_t c) { return c > 0; });
    const auto twice = std::count(counts_.begin(), counts_.end(), 2);
    return covered > 0 ? static_cast<double>(twice) / static_cast<double>(covered) : 0;
  }

 private:
  /// Texels visited in all: far beyond any sane atlas. Triangles that come later are not counted.
  static constexpr int64_t work_limit = int64_t{1} << 28;

  void add_row(const UvTriangle& t, int y) {
    double low = 1e300, high = -1e300;
    for (std::size_t k = 0; k < 3; ++k) {
      // From the lower end to the upper, so that both triangles of an edge compute the same crossing.
      Vec2 a = t[k], b = t[(k + 1) % 3];
      if (a.y > b.y) std::swap(a, b);
      if (!(a.y <= y && y < b.y)) continue;
      const double x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
      low = std::min(low, x), high = std::max(high, x);
    }
    if (low > high) return;
    const double tile = std::floor(low / size) * size;
    low -= tile, high -= tile;
    const int first = static_cast<int>(std::ceil(low));
    const int last = static_cast<int>(std::min(std::ceil(high), low + 3.0 * size));
    uint8_t* row = counts_.data() + std::size_t{size} * static_cast<std::size_t>(wrapped(y));
    for (int x = first; x < last; ++x) {
      uint8_t& count = row[wrapped(x)];
      if (count < 2) ++count;
    }
    work_ += 1 + std::max(0, last - first);
  }
  static int wrapped(int i) { return ((i % size) + size) % size; }

  std::vector<uint8_t> counts_;
  int64_t work_ = 0;
};

/// The UVs at the lower and the higher end of a side.
std::array<Vec2f, 2> end_uvs(const TriangleMesh& mesh, const std::vector<Vec2f>& uvs,
                             const TriangleSide& side) {
  const Index3& index = mesh.attributes[side.triangle];
  const Vec2f from = uvs[index[side.side]], to = uvs[index[(side.side + 1) % 3]];
  return side.forward ? std::array{from, to} : std::array{to, from};
}

/// One number per chart: triangles that share an edge with equal UVs on it are of one chart.
std::size_t number_charts(const TriangleMesh& mesh, const std::vector<Vec2f>& uvs,
                          std::vector<uint32_t>& chart) {
  DisjointSets sets(mesh.triangle_count());
  for_each_edge(sorted_sides(mesh), [&](const TriangleSide* first, const TriangleSide* last) {
    for (const TriangleSide* a = first; a != last; ++a)
      for (const TriangleSide* b = a + 1; b != last; ++b)
        if (end_uvs(mesh, uvs, *a) == end_uvs(mesh, uvs, *b)) sets.unite(a->triangle, b->triangle);
  });
  return sets.number(chart);
}

}  // namespace

std::vector<UvSeam> find_uv_seams(const TriangleMesh& mesh, std::size_t uv_set) {
  std::vector<UvSeam> seams;
  if (uv_set >= mesh.uv_sets.size() || mesh.uv_sets[uv_set].empty()) return seams;
  const std::vector<Vec2f>& uvs = mesh.uv_sets[uv_set];
  for_each_edge(sorted_sides(mesh), [&](const TriangleSide* first, const TriangleSide* last) {
    if (last - first != 2 || end_uvs(mesh, uvs, first[0]) == end_uvs(mesh, uvs, first[1])) return;
    seams.push_back({first[0].triangle, first[1].triangle, first[0].side, first[1].side,
                     first[0].forward != first[1].forward});
  });
  return seams;
}

UvAtlas::UvAtlas(const TriangleMesh& mesh, std::size_t uv_set) {
  if (uv_set >= mesh.uv_sets.size() || mesh.uv_sets[uv_set].empty()) return;
  const std::vector<Vec2f>& uvs = mesh.uv_sets[uv_set];
  chart_count_ = number_charts(mesh, uvs, chart_of_triangle_);
  uv_per_metre_.assign(mesh.triangle_count(), 0);
  gradients_.assign(mesh.triangle_count(), {Vec3f(0), Vec3f(0)});
  CoverageRaster raster;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    UvTriangle uv;
    bool finite = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2f corner = uvs[mesh.attributes[t][k]];
      uv[k] = Vec2(corner);
      if (!is_finite(corner))
        finite = false, ++non_finite_corners;
      else if (std::min(corner.x, corner.y) < 0 || std::max(corner.x, corner.y) > 1)
        ++out_of_range_corners;
    }
    if (!finite) continue;
    set_jacobian(mesh, t, uv);
    raster.add(uv);
  }
  overlap_fraction = raster.overlap_fraction();
}

/// Gradients of u and v in the plane of the triangle, N = e1 x e2: (du1 e2 x N + du2 N x e1) / |N|^2.
void UvAtlas::set_jacobian(const TriangleMesh& mesh, uint32_t t, const UvTriangle& uv) {
  if (twice_signed_area(uv) == 0) ++zero_area_triangles;
  const Index3& c = mesh.corners[t];
  const Vec3 e1 = mesh.positions[c[1]] - mesh.positions[c[0]],
             e2 = mesh.positions[c[2]] - mesh.positions[c[0]];
  const Vec3 n = glm::cross(e1, e2);
  const double squared = length_squared(n);
  if (!(squared > 0)) return;
  const Vec2 d1 = uv[1] - uv[0], d2 = uv[2] - uv[0];
  const Vec3 across1 = glm::cross(e2, n) / squared, across2 = glm::cross(n, e1) / squared;
  gradients_[t] = {Vec3f(d1.x * across1 + d2.x * across2), Vec3f(d1.y * across1 + d2.y * across2)};
  uv_per_metre_[t] = static_cast<float>(std::sqrt(std::abs(twice_signed_area(uv)) / std::sqrt(squared)));
}

Vec2 UvAtlas::uv_from_surface(uint32_t triangle, const Vec3& displacement) const {
  const auto& [u, v] = gradients_[triangle];
  return {glm::dot(Vec3(u), displacement), glm::dot(Vec3(v), displacement)};
}

}  // namespace alabaster
