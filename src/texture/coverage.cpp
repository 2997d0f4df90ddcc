#include "texture/coverage.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_set>

#include "geometry/triangle.h"

namespace alabaster {

namespace {

constexpr double most_tiles = 4096;
// A chart without texel centres is a splinter of an atlas from this share of the mean density on.
constexpr double splinter_density = 0.125;
constexpr float least_palette_weight = 1e-3f;

// A convex polygon of at most seven corners: a triangle clipped by four lines.
struct Polygon {
  std::array<Vec2, 8> points{};
  int count = 0;
  void add(const Vec2& p) { points[static_cast<std::size_t>(count++)] = p; }
  const Vec2& operator[](int i) const { return points[static_cast<std::size_t>(i)]; }

  double area() const {
    double twice = 0;
    for (int i = 2; i < count; ++i) {
      const Vec2 a = points[static_cast<std::size_t>(i - 1)] - points[0];
      const Vec2 b = points[static_cast<std::size_t>(i)] - points[0];
      twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * std::abs(twice);
  }
};

// The part where sign * p[axis] >= sign * bound (Sutherland and Hodgman 1974, one plane).
Polygon clip(const Polygon& polygon, int axis, double bound, double sign) {
  Polygon result;
  for (int i = 0; i < polygon.count; ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = polygon[i + 1 < polygon.count ? i + 1 : 0];
    const double da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
    if (da >= 0) result.add(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      Vec2 crossing = a + (da / (da - db)) * (b - a);
      crossing[axis] = bound;
      result.add(crossing);
    }
  }
  return result;
}

struct Interval {
  double low, high;
};
Interval extent(const Polygon& polygon, int axis) {
  Interval result{polygon[0][axis], polygon[0][axis]};
  for (int i = 1; i < polygon.count; ++i) {
    result.low = std::min(result.low, polygon[i][axis]);
    result.high = std::max(result.high, polygon[i][axis]);
  }
  return result;
}

// Texels [first, last] that an interval touches.
std::array<int, 2> touched(const Interval& interval) {
  const int first = static_cast<int>(std::floor(interval.low));
  return {first, std::max(first, static_cast<int>(std::ceil(interval.high)) - 1)};
}

// The stretch of the horizontal line y inside a convex polygon; empty (low > high) where it passes by.
Interval cross_section(const Polygon& polygon, double y) {
  Interval result{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (int i = 0; i < polygon.count; ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = polygon[i + 1 < polygon.count ? i + 1 : 0];
    if (std::min(a.y, b.y) > y || std::max(a.y, b.y) < y) continue;
    const double x = a.y == b.y ? a.x : a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
    result.low = std::min(result.low, a.y == b.y ? std::min(a.x, b.x) : x);
    result.high = std::max(result.high, a.y == b.y ? std::max(a.x, b.x) : x);
  }
  return result;
}

// Texel index of a column and row under the wrap modes.
struct TexelIndex {
  int width, height;
  const TextureMapping& mapping;
  std::size_t operator()(int column, int row) const {
    return static_cast<std::size_t>(wrap_index(row, height, mapping.wrap_v)) *
               static_cast<std::size_t>(width) +
           static_cast<std::size_t>(wrap_index(column, width, mapping.wrap_u));
  }
};

// Calls visit(column, row) for the texels whose centre lies in a polygon with corners in texels.
template <class Visit>
void for_each_centre(const Polygon& polygon, Visit&& visit) {
  constexpr double rounding = 1e-6;
  const Interval y = extent(polygon, 1);
  for (int row = static_cast<int>(std::ceil(y.low - 0.5)); row + 0.5 <= y.high; ++row) {
    const Interval x = cross_section(polygon, row + 0.5);
    for (int column = static_cast<int>(std::ceil(x.low - 0.5 - rounding)); column + 0.5 <= x.high + rounding;
         ++column)
      visit(column, row);
  }
}

// Calls visit(column, row, area) for every texel that a polygon touches.
template <class Visit>
void for_each_touched(const Polygon& polygon, Visit&& visit) {
  const auto rows = touched(extent(polygon, 1));
  for (int row = rows[0]; row <= rows[1]; ++row) {
    Polygon rest = clip(clip(polygon, 1, row, 1), 1, row + 1, -1);
    if (rest.count == 0) continue;
    const auto columns = touched(extent(rest, 0));
    for (int column = columns[0]; column <= columns[1] && rest.count > 0; ++column) {
      visit(column, row, clip(rest, 0, column + 1, -1).area());
      rest = clip(rest, 0, column + 1, 1);
    }
  }
}

// Corners in texels; nothing where they are not usable.
std::optional<Polygon> polygon_in_texels(const TriangleMesh& mesh, uint32_t triangle,
                                         const TextureMapping& mapping, Vec2 size) {
  Polygon polygon;
  for (const uint32_t corner : mesh.attributes[triangle])
    polygon.add(mapping.transform(Vec2(mesh.uv_sets[mapping.uv_set][corner])) * size);
  for (int axis = 0; axis < 2; ++axis) {
    const Interval range = extent(polygon, axis);
    double sum = 0;  // catches what comparisons of NaN let through
    for (int i = 0; i < 3; ++i) sum += std::abs(polygon[i][axis]);
    if (!(sum < 1e9 && range.high - range.low < most_tiles * size[axis])) return std::nullopt;
  }
  return polygon;
}

// UV units per metre of every chart and, area-weighted, of all, from the triangles given.
struct Densities {
  std::vector<double> of_chart;
  double mean = 0;
};
Densities densities(const TriangleMesh& mesh, const UvAtlas& atlas, std::span<const uint32_t> triangles) {
  Densities result;
  result.of_chart.resize(atlas.chart_count());
  std::vector<double> areas(atlas.chart_count());
  double total = 0;
  for (const uint32_t triangle : triangles) {
    const double area = mesh.area(triangle), weighted = area * atlas.uv_per_metre(triangle);
    if (!std::isfinite(weighted)) continue;
    result.of_chart[atlas.chart(triangle)] += weighted;
    areas[atlas.chart(triangle)] += area;
    result.mean += weighted;
    total += area;
  }
  for (std::size_t chart = 0; chart < areas.size(); ++chart)
    if (areas[chart] > 0) result.of_chart[chart] /= areas[chart];
  if (total > 0) result.mean /= total;
  return result;
}

}  // namespace

Coverage texel_coverage(const TriangleMesh& mesh, const UvAtlas& atlas, std::span<const uint32_t> triangles,
                        const TextureMapping& mapping, int width, int height) {
  assert(mapping.uv_set < mesh.uv_sets.size());
  const TexelIndex index{width, height, mapping};
  const Vec2 size(width, height);
  Coverage result;
  result.weights.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<bool> has_centre(atlas.chart_count());
  for (const uint32_t triangle : triangles)
    if (const auto polygon = polygon_in_texels(mesh, triangle, mapping, size))
      for_each_centre(*polygon, [&](int column, int row) {
        result.weights[index(column, row)] = 1;
        has_centre[atlas.chart(triangle)] = true;
      });
  const bool any = std::find(has_centre.begin(), has_centre.end(), true) != has_centre.end();
  const Densities density = densities(mesh, atlas, triangles);
  for (const uint32_t triangle : triangles) {
    const uint32_t chart = atlas.chart(triangle);
    const auto polygon = polygon_in_texels(mesh, triangle, mapping, size);
    if (polygon && has_centre[chart]) continue;
    if (!polygon || (any && density.of_chart[chart] >= splinter_density * density.mean)) {
      result.untexeled.push_back(triangle);
      continue;
    }
    for_each_touched(*polygon, [&](int column, int row, double area) {
      float& weight = result.weights[index(column, row)];
      weight = std::clamp(weight + static_cast<float>(area), least_palette_weight, 1.0f);
    });
  }
  return result;
}

std::unordered_map<uint32_t, Vec2> substitute_uvs(const TriangleMesh& mesh,
                                                  std::span<const uint32_t> triangles,
                                                  std::span<const uint32_t> untexeled, std::size_t uv_set) {
  std::unordered_map<uint32_t, Vec2> result;
  if (untexeled.empty()) return result;
  const std::unordered_set<uint32_t> without(untexeled.begin(), untexeled.end());
  std::unordered_multimap<uint32_t, uint32_t> around;  // position -> triangles
  for (const uint32_t triangle : triangles)
    for (const uint32_t position : mesh.corners[triangle]) around.emplace(position, triangle);
  for (const uint32_t triangle : untexeled) {
    const Vec3 middle = mesh.position(triangle, Vec2(1.0 / 3));
    Vec2& uv = result[triangle];
    uv = mesh.uv(triangle, Vec2(1.0 / 3), uv_set);
    double nearest = std::numeric_limits<double>::infinity();
    std::unordered_set<uint32_t> seen{triangle};
    std::vector<uint32_t> ring{triangle};
    while (!ring.empty() && nearest == std::numeric_limits<double>::infinity()) {
      std::vector<uint32_t> next;
      for (const uint32_t member : ring)
        for (const uint32_t position : mesh.corners[member]) {
          const auto [begin, end] = around.equal_range(position);
          for (auto entry = begin; entry != end; ++entry)
            if (seen.insert(entry->second).second) next.push_back(entry->second);
        }
      for (const uint32_t candidate : next) {
        if (without.count(candidate) > 0) continue;
        const auto& c = mesh.corners[candidate];
        const Triangle corners{mesh.positions[c[0]], mesh.positions[c[1]], mesh.positions[c[2]]};
        const Vec2 closest = corners.closest(middle);
        const double distance = glm::distance(corners.point(closest), middle);
        if (distance < nearest) nearest = distance, uv = mesh.uv(candidate, closest, uv_set);
      }
      ring = std::move(next);
    }
  }
  return result;
}

void for_each_covered_texel(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                            const TextureMapping& mapping, int width, int height,
                            const std::function<void(std::size_t, uint32_t, Vec2)>& visit) {
  const TexelIndex index{width, height, mapping};
  for (const uint32_t triangle : triangles) {
    const auto polygon = polygon_in_texels(mesh, triangle, mapping, Vec2(width, height));
    if (!polygon) continue;
    const Vec2 a = (*polygon)[0], ab = (*polygon)[1] - a, ac = (*polygon)[2] - a;
    const double area = ab.x * ac.y - ab.y * ac.x;
    for_each_centre(*polygon, [&](int column, int row) {
      const Vec2 p = Vec2(column + 0.5, row + 0.5) - a;
      const Vec2 barycentric =
          area != 0 ? Vec2(p.x * ac.y - p.y * ac.x, ab.x * p.y - ab.y * p.x) / area : Vec2(0);
      visit(index(column, row), triangle, glm::clamp(barycentric, 0.0, 1.0));
    });
  }
}

}  // namespace alabaster
