#include "texture/surface_pyramid.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "core/parallel.h"

namespace alabaster {

namespace {

// A node averages a Gaussian of this many spacings squared along each axis; reading trilinearly adds 1/6 on
// average (0 at a node, 1/4 between two: the deviation is within 5 % everywhere).
constexpr double node_variance = 1.25, reading_variance = 1.0 / 6;
constexpr double level_variance = node_variance + reading_variance;
// Spacings double every third level: a blend of two neighbours' Gaussians has an excess kurtosis of at most
// 0.16, and is off by less than 0.5 % of contrast.
constexpr std::size_t families = 3;
constexpr std::array<double, families + 1> family_variance{1, 1.5874010519681994, 2.519842099789746, 4};
// Points are spread to 3 x 3 x 3 nodes by the quadratic B-spline, of variance 1/4.
constexpr double spline_variance = 0.25;
constexpr int blur_reach = 3, blur_taps = 2 * blur_reach + 1;
// Nodes are kept this far, in nodes, around those that points were spread to: a lookup of this level may be
// 1.5 spacings away from the surface.
constexpr int band = 0;
constexpr int padding = 4;  // nodes around the object
constexpr double most_spacings = 700, samples_per_spacing = 5;
constexpr float least_weight = 1e-7f;

/// A piece of surface.
struct Splat {
  Vec3f position;  // from the middle of the object, m
  float area;      // m^2
  Vec3f albedo;
};

/// Of level k, in units of the finest level's.
double variance_of(std::size_t k) {
  return std::exp2(2.0 * static_cast<double>(k / families)) * family_variance[k % families];
}

// A triangle's cuts: its longest edge into `along`, its height above that into `across` where it is highest.
struct Cuts {
  int along = 1, across = 1;
  int edge = 0;     // the corner at which the longest edge begins
  double foot = 0;  // where the third corner stands above the longest edge, 0 .. 1

  // Slivers are cut into slices across, or a needle would take the square of its length in points.
  bool sliver() const { return 2 * across < along; }
};

Cuts cuts_of(const TriangleMesh& mesh, uint32_t triangle, double spacing) {
  const Index3& c = mesh.corners[triangle];
  Cuts result;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = glm::distance(mesh.positions[c[k]], mesh.positions[c[(k + 1) % 3]]);
    if (length > longest) longest = length, result.edge = static_cast<int>(k);
  }
  if (!(longest > 0)) return result;
  const auto count = [&](double length) {
    return static_cast<int>(std::clamp(std::ceil(length / spacing), 1.0, 2048.0));
  };
  result.along = count(longest);
  result.across = count(2 * mesh.area(triangle) / longest);
  const auto corner = [&](int k) {
    return mesh.positions[c[static_cast<std::size_t>((result.edge + k) % 3)]];
  };
  const Vec3 base = corner(1) - corner(0);
  result.foot = std::clamp(glm::dot(corner(2) - corner(0), base) / (longest * longest), 0.0, 1.0);
  return result;
}

// Calls visit(barycentric, share of the area) for the pieces of a sliver between `from` and `to` of its
// longest edge, where its height rises or falls from `height` to `height_to` (1: the highest).
template <class Visit>
void for_each_slice(const Cuts& cuts, double from, double to, double height, double height_to,
                    const Visit& visit) {
  const int slices = static_cast<int>(std::ceil(cuts.along * (to - from)));
  const double step = (to - from) / slices, rise = (height_to - height) / slices;
  for (int i = 0; i < slices; ++i) {
    const double low = height + i * rise, high = low + rise;  // of a trapezium
    const int pieces = std::max(1, static_cast<int>(std::ceil(cuts.across * std::max(low, high))));
    const double t = from + step * (i + (low + 2 * high) / (3 * (low + high)));
    const double mean_height = 2.0 / 3 * (low * low + low * high + high * high) / (low + high);
    for (int j = 0; j < pieces; ++j) {
      const double h = mean_height * (j + 0.5) / pieces;
      std::array<double, 3> weight;
      weight[static_cast<std::size_t>(cuts.edge)] = 1 - t - h * (1 - cuts.foot);
      weight[static_cast<std::size_t>((cuts.edge + 1) % 3)] = t - h * cuts.foot;
      weight[static_cast<std::size_t>((cuts.edge + 2) % 3)] = h;
      visit(Vec2(weight[1], weight[2]), step * (low + high) / pieces);
    }
  }
}

// The same for all of a triangle.
template <class Visit>
void for_each_piece(const Cuts& cuts, const Visit& visit) {
  if (cuts.sliver()) {
    for_each_slice(cuts, 0, cuts.foot, 0, 1, visit);
    for_each_slice(cuts, cuts.foot, 1, 1, 0, visit);
    return;
  }
  const int n = cuts.along;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * (n - j) - 1; ++i) {
      // Even ones point as the whole does, odd ones stand on their heads between them.
      const double third = i % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
      visit(Vec2(i / 2 + third, j + third) / static_cast<double>(n), 1.0 / n / n);
    }
}

std::size_t piece_count(const Cuts& cuts) {
  std::size_t count = 0;
  if (cuts.sliver())
    for_each_piece(cuts, [&](const Vec2&, double) { ++count; });
  else
    count = static_cast<std::size_t>(cuts.along) * static_cast<std::size_t>(cuts.along);
  return count;
}

void add_triangle(const TriangleMesh& mesh, uint32_t triangle, const Cuts& cuts, const AlbedoField& field,
                  const Vec3& middle, Splat* out) {
  const double area = mesh.area(triangle);
  const SurfacePoint corner = mesh.surface_point(triangle, Vec2(0));
  const Vec3 ab = mesh.position(triangle, {1, 0}) - corner.position,
             ac = mesh.position(triangle, {0, 1}) - corner.position;
  const Vec2 uv_ab = mesh.uv(triangle, {1, 0}) - corner.uv, uv_ac = mesh.uv(triangle, {0, 1}) - corner.uv;
  SurfacePoint point = corner;
  for_each_piece(cuts, [&](const Vec2& b, double share) {
    point.barycentric = b;
    point.position = corner.position + b.x * ab + b.y * ac;
    point.uv = corner.uv + b.x * uv_ab + b.y * uv_ac;
    const Rgb albedo = field.at(point);
    *out++ = {Vec3f(point.position - middle), static_cast<float>(share * area),
              Vec3f(albedo.r, albedo.g, albedo.b)};
  });
}

std::vector<Splat> surface_splats(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                                  const AlbedoField& field, const Vec3& middle, double spacing) {
  std::vector<std::size_t> first(triangles.size() + 1, 0);
  std::vector<Cuts> cuts(triangles.size());
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    cuts[k] = cuts_of(mesh, triangles[k], spacing);
    first[k + 1] = first[k] + piece_count(cuts[k]);
  }
  std::vector<Splat> splats(first.back());
  parallel_for(triangles.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      add_triangle(mesh, triangles[k], cuts[k], field, middle, splats.data() + first[k]);
  });
  return splats;
}

// Weights of the Gaussian that leads from what spreading left to node_variance, in spacings.
std::array<float, blur_taps> blur_weights(double variance) {
  // What is cut off narrows the kernel; a few rounds find the one of the wanted variance.
  std::array<double, blur_taps> weights{};
  double nominal = variance;
  for (int round = 0; round < 8; ++round) {
    double sum = 0, second = 0;
    for (int k = -blur_reach; k <= blur_reach; ++k) {
      const double w = weights[static_cast<std::size_t>(k + blur_reach)] = std::exp(-0.5 * k * k / nominal);
      sum += w, second += w * k * k;
    }
    for (double& w : weights) w /= sum;
    nominal *= variance / (second / sum);
  }
  std::array<float, blur_taps> result{};
  std::transform(weights.begin(), weights.end(), result.begin(),
                 [](double w) { return static_cast<float>(w); });
  return result;
}

}  // namespace

/// Points spread onto the nodes of a grid of one spacing, bricks of 8 x 8 x 8 nodes that share none.
class SurfacePyramid::Splatting {
 public:
  /// `size` is the extent of the points around 0, m.
  Splatting(const Vec3& size, double spacing, double added_variance)
      : spacing_(spacing),
        per_spacing_(1 / spacing),
        origin_(-0.5 * size - padding * spacing),
        added_variance_(added_variance) {
    std::size_t count = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      nodes_[k] = static_cast<int>(std::ceil(size[static_cast<int>(k)] / spacing)) + 2 * padding + 1;
      bricks_[k] = (nodes_[k] + brick_nodes - 1) / brick_nodes;
      count *= static_cast<std::size_t>(bricks_[k]);
    }
    index_.assign(count, no_index);
  }

  void add(const Vec3& p, const Vec4f& value) {
    std::array<std::array<float, 3>, 3> weight;
    std::array<int, 3> first;
    bool one_brick = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<int>(axis);
      const double q = (p[a] - origin_[a]) * per_spacing_ + 0.5;  // positive
      const int nearest = static_cast<int>(q);
      const auto f = static_cast<float>(q - nearest) - 0.5f;
      weight[axis] = {0.5f * (0.5f - f) * (0.5f - f), 0.75f - f * f, 0.5f * (0.5f + f) * (0.5f + f)};
      first[axis] = nearest - 1;
      one_brick = one_brick && first[axis] % brick_nodes <= brick_nodes - 3;
      assert(first[axis] >= 0 && first[axis] + 2 < nodes_[axis]);
    }
    Vec4f* corner = one_brick ? &node(first[0], first[1], first[2]) : nullptr;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) {
        const Vec4f part =
            value * (weight[2][static_cast<std::size_t>(k)] * weight[1][static_cast<std::size_t>(j)]);
        for (int i = 0; i < 3; ++i) {
          Vec4f& target = one_brick ? corner[(k * brick_nodes + j) * brick_nodes + i]
                                    : node(first[0] + i, first[1] + j, first[2] + k);
          target += weight[0][static_cast<std::size_t>(i)] * part;
        }
      }
  }

  /// Null where nothing was spread.
  const Vec4f* find(int x, int y, int z) const {
    if (std::min({x, y, z}) < 0 || x >= nodes_[0] || y >= nodes_[1] || z >= nodes_[2]) return nullptr;
    const uint32_t brick = index_[brick_index(x, y, z)];
    return brick == no_index ? nullptr : &values_[brick * brick_size + offset(x, y, z)];
  }

  /// Calls visit(x, y, z, value) for every node that holds something.
  template <class Visit>
  void for_each(const Visit& visit) const {
    std::size_t brick = 0;
    for (int bz = 0; bz < bricks_[2]; ++bz)
      for (int by = 0; by < bricks_[1]; ++by)
        for (int bx = 0; bx < bricks_[0]; ++bx, ++brick) {
          if (index_[brick] == no_index) continue;
          for (std::size_t i = 0; i < brick_size; ++i) {
            const Vec4f& value = values_[index_[brick] * brick_size + i];
            const int n = static_cast<int>(i);
            if (value.w > 0)
              visit(bx * brick_nodes + n % 8, by * brick_nodes + n / 8 % 8, bz * brick_nodes + n / 64, value);
          }
        }
  }

  /// The same points on a coarser grid, of `ratio` times the spacing.
  Splatting coarser(const Vec3& size, double ratio) const {
    const double squared = ratio * ratio;
    Splatting result(size, ratio * spacing_, variance() / squared);
    // A node's value is mass per squared spacing.
    for_each([&](int x, int y, int z, const Vec4f& value) {
      result.add(origin_ + spacing_ * Vec3(x, y, z), static_cast<float>(1 / squared) * value);
    });
    return result;
  }

  double spacing() const { return spacing_; }
  const Vec3& origin() const { return origin_; }
  const std::array<int, 3>& nodes() const { return nodes_; }
  /// What the points have been blurred by, in spacings squared.
  double variance() const { return added_variance_ + spline_variance; }

 private:
  std::size_t brick_index(int x, int y, int z) const {
    return static_cast<std::size_t>(((z / brick_nodes) * bricks_[1] + y / brick_nodes) * bricks_[0] +
                                    x / brick_nodes);
  }
  static std::size_t offset(int x, int y, int z) {
    return static_cast<std::size_t>(((z % brick_nodes) * brick_nodes + y % brick_nodes) * brick_nodes +
                                    x % brick_nodes);
  }
  Vec4f& node(int x, int y, int z) {
    uint32_t& brick = index_[brick_index(x, y, z)];
    if (brick == no_index) {
      brick = static_cast<uint32_t>(values_.size() / brick_size);
      values_.resize(values_.size() + brick_size, Vec4f(0));
    }
    return values_[brick * brick_size + offset(x, y, z)];
  }

  double spacing_, per_spacing_;
  Vec3 origin_;
  double added_variance_;  // of the points themselves, spacings squared
  std::array<int, 3> nodes_{}, bricks_{};
  std::vector<uint32_t> index_;
  std::vector<Vec4f> values_;
};

namespace {

// Nodes of one brick and those that the blur reaches around it.
constexpr int inner = 8, outer = inner + 2 * blur_reach;

struct Workspace {
  std::vector<Vec4f> wide = std::vector<Vec4f>(outer * outer * outer);
  std::vector<Vec4f> along_x = std::vector<Vec4f>(outer * outer * inner);
  std::vector<Vec4f> along_xy = std::vector<Vec4f>(outer * inner * inner);
};

// Blurs along the fastest axis of a block of `rows` rows and turns it: out[column][row].
void blur_and_turn(const Vec4f* in, int rows, const std::array<float, blur_taps>& weights, Vec4f* out) {
  for (int row = 0; row < rows; ++row, in += outer)
    for (int i = 0; i < inner; ++i) {
      Vec4f sum(0);
      for (int k = 0; k < blur_taps; ++k) sum += weights[static_cast<std::size_t>(k)] * in[i + k];
      out[i * rows + row] = sum;
    }
}

}  // namespace

SurfacePyramid::Level SurfacePyramid::blur(const Splatting& splats) const {
  Level level;
  level.origin = splats.origin();
  level.nodes_per_metre = 1 / splats.spacing();
  std::size_t count = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    level.bricks[k] = (splats.nodes()[k] - 1 + brick_cells - 1) / brick_cells;
    level.limit[k] = level.bricks[k] * brick_cells - 1e-6;
    count *= static_cast<std::size_t>(level.bricks[k]);
  }
  level.index.assign(count, no_index);
  uint32_t used = 0;
  splats.for_each([&](int x, int y, int z, const Vec4f&) {
    // Bricks that hold a cell within the band.
    const auto range = [&](int node, std::size_t axis) {
      return std::pair{std::max(node - band - 1, 0) / brick_cells,
                       std::min((node + band) / brick_cells, level.bricks[axis] - 1)};
    };
    const auto [x0, x1] = range(x, 0);
    const auto [y0, y1] = range(y, 1);
    const auto [z0, z1] = range(z, 2);
    for (int bz = z0; bz <= z1; ++bz)
      for (int by = y0; by <= y1; ++by)
        for (int bx = x0; bx <= x1; ++bx) {
          uint32_t& brick =
              level.index[static_cast<std::size_t>((bz * level.bricks[1] + by) * level.bricks[0] + bx)];
          if (brick == no_index) brick = used++;
        }
  });
  std::vector<Vec4f> nodes(used * brick_size);
  const auto weights = blur_weights(node_variance - splats.variance());
  parallel_for(count, 512, [&](std::size_t begin, std::size_t end) {
    Workspace work;
    for (std::size_t b = begin; b < end; ++b) {
      if (level.index[b] == no_index) continue;
      const int n = static_cast<int>(b);
      const int x0 = n % level.bricks[0] * brick_cells - blur_reach,
                y0 = n / level.bricks[0] % level.bricks[1] * brick_cells - blur_reach,
                z0 = n / level.bricks[0] / level.bricks[1] * brick_cells - blur_reach;
      Vec4f* out = work.wide.data();
      for (int z = 0; z < outer; ++z)
        for (int y = 0; y < outer; ++y)
          for (int x = 0; x < outer; ++x) {
            const Vec4f* found = splats.find(x0 + x, y0 + y, z0 + z);
            *out++ = found != nullptr ? *found : Vec4f(0);
          }
      // (z y)x -> x(z y), (x z)y -> y(x z), (y x)z -> z(y x): three turns bring the order back.
      blur_and_turn(work.wide.data(), outer * outer, weights, work.along_x.data());
      blur_and_turn(work.along_x.data(), inner * outer, weights, work.along_xy.data());
      blur_and_turn(work.along_xy.data(), inner * inner, weights, nodes.data() + level.index[b] * brick_size);
    }
  });
  float largest = 0;
  for (const Vec4f& node : nodes) largest = std::max(largest, node.w);
  level.weight_unit = largest / largest_code;
  level.nodes.resize(nodes.size());
  parallel_for(nodes.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) level.nodes[i] = range_.pack(nodes[i], 1 / level.weight_unit);
  });
  return level;
}

SurfacePyramid::SurfacePyramid(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                               const AlbedoField& field, double finest) {
  BoundingBox box;
  for (const uint32_t t : triangles)
    for (const uint32_t corner : mesh.corners[t]) box.extend(mesh.positions[corner]);
  const Vec3 size = box.high - box.low, middle = box.centre();
  const double extent = std::max({size.x, size.y, size.z});
  double spacing = std::max(finest / std::sqrt(level_variance), extent / most_spacings);
  assert(spacing > 0);
  finest_ = spacing * std::sqrt(level_variance);
  inverse_finest_variance_ = 1 / (finest_ * finest_);

  const std::vector<Splat> splats =
      surface_splats(mesh, triangles, field, middle, spacing / samples_per_spacing);
  Vec3f low(std::numeric_limits<float>::infinity()), high(-low);
  for (const Splat& s : splats) low = glm::min(low, s.albedo), high = glm::max(high, s.albedo);
  range_ = PackedRange(Rgb(low.x, low.y, low.z), Rgb(high.x, high.y, high.z));

  // Wide enough for any Gaussian between two points of the object.
  std::size_t count = 2;
  while (finest_ * std::sqrt(variance_of(count - 1)) < 0.6 * box.diagonal()) ++count;
  levels_.resize(count);
  Splatting finest_grid(size, spacing, 0);
  const double per_area = 1 / (spacing * spacing);
  for (const Splat& s : splats)
    finest_grid.add(Vec3(s.position),
                    Vec4f(s.albedo, 1) * static_cast<float>(per_area * static_cast<double>(s.area)));
  parallel_for(families, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t family = begin; family < end; ++family) {
      std::optional<Splatting> grid;
      for (std::size_t k = family; k < levels_.size(); k += families) {
        const Splatting& finer = grid ? *grid : finest_grid;
        if (k > 0) grid = finer.coarser(size, k < families ? std::sqrt(family_variance[k]) : 2);
        levels_[k] = blur(grid ? *grid : finest_grid);
        levels_[k].origin += middle;
      }
    }
  });
}

double SurfacePyramid::sigma_of_spacing(double spacing) {
  return spacing * std::sqrt(level_variance);
}

Vec4f SurfacePyramid::sum(const Level& level, const Vec3& p) const {
  std::array<int, 3> brick{}, cell{};
  std::array<float, 3> f{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<int>(axis);
    const double q = std::clamp((p[a] - level.origin[a]) * level.nodes_per_metre, 0.0, level.limit[axis]);
    const int node = static_cast<int>(q);
    f[axis] = static_cast<float>(q - node);
    brick[axis] = node / brick_cells;
    cell[axis] = node - brick_cells * brick[axis];
  }
  const uint32_t found = level.index[static_cast<std::size_t>(
      (brick[2] * level.bricks[1] + brick[1]) * level.bricks[0] + brick[0])];
  if (found == no_index) return Vec4f(0);
  const PackedTexel* corner =
      level.nodes.data() + found * brick_size +
      static_cast<std::size_t>((cell[2] * brick_nodes + cell[1]) * brick_nodes + cell[0]);
  const float unit = level.weight_unit;
  const Float8 units{unit, unit, unit, unit, unit, unit, unit, unit};
  const auto pair = [&](int offset) { return weighted_pair(load_pair(corner + offset), units); };
  const Float8 near = pair(0) + f[1] * (pair(brick_nodes) - pair(0));
  constexpr int layer = brick_nodes * brick_nodes;
  const Float8 far = pair(layer) + f[1] * (pair(layer + brick_nodes) - pair(layer));
  const Float8 both = near + f[2] * (far - near);
  Float4 ends[2];
  std::memcpy(ends, &both, sizeof ends);
  const Float4 value = ends[0] + f[0] * (ends[1] - ends[0]);
  Vec4f result;
  std::memcpy(&result, &value, sizeof result);
  return result;
}

Rgb SurfacePyramid::filtered(const Vec3& p, double sigma) const {
  // Between two levels both are mixed by variance.
  const double ratio = std::clamp(sigma * sigma * inverse_finest_variance_, 1.0, 1e30);
  const auto bits = std::bit_cast<uint64_t>(ratio);
  const uint64_t octave = ((bits >> 52) - 1023) / 2, exponent = (2 * octave + 1023) << 52;
  const double within = ratio / std::bit_cast<double>(exponent);  // 1 to 4
  std::size_t family = 0;
  while (family + 1 < families && within >= family_variance[family + 1]) ++family;
  const std::size_t last = levels_.size() - 1;
  std::size_t k = std::min(families * octave + family, last);
  Vec4f total = sum(levels_[k], p);
  const double low = family_variance[family], share = (within - low) / (family_variance[family + 1] - low);
  if (k < last && share > 0) total += static_cast<float>(share) * (sum(levels_[k + 1], p) - total);
  while (!(total.w > least_weight) && k < last) total = sum(levels_[++k], p);
  return total.w > least_weight ? range_.mean(total) : range_.low();
}

std::size_t SurfacePyramid::memory_bytes() const {
  std::size_t bytes = sizeof *this;
  for (const Level& level : levels_)
    bytes += sizeof level + level.nodes.size() * sizeof(PackedTexel) + level.index.size() * sizeof(uint32_t);
  return bytes;
}

}  // namespace alabaster
