#include "texture/vertex_albedo.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <unordered_map>

#include "core/parallel.h"
#include "core/rng.h"

namespace alabaster {

namespace {

// Clusters are this share of the Gaussian's deviation wide; its reach is in deviations.
constexpr double cluster_size = 0.5, reach = 3;
// A way over the surface longer than this times the straight line (and a deviation) leads to another side.
constexpr double detour = 1.5;

// A patch of surface: the part of the mesh in one cell of a grid that faces one of six ways.
struct Cluster {
  Vec3 centre{0};  // times area until the end
  Vec3 albedo{0};  // times area
  double area = 0;
};

struct Clusters {
  std::vector<Cluster> all;
  std::vector<uint32_t> of_position;
  std::vector<std::vector<uint32_t>> neighbours;
};

// Which of the six ways a normal faces most.
uint64_t facing(const Vec3& n) {
  const Vec3 a = glm::abs(n);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return static_cast<uint64_t>(2 * axis + (n[axis] < 0 ? 1 : 0));
}

std::vector<Vec3> position_normals(const TriangleMesh& mesh, std::span<const uint32_t> triangles) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3(0));
  for (const uint32_t t : triangles) {
    const Vec3 n = mesh.geometric_normal(t) * mesh.area(t);
    for (const uint32_t p : mesh.corners[t]) normals[p] += n;
  }
  return normals;
}

Clusters make_clusters(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                       const std::vector<Vec3>& normals, const std::vector<Rgb>& albedo, double cell) {
  Clusters result;
  result.of_position.assign(mesh.positions.size(), no_index);
  std::unordered_map<uint64_t, uint32_t> index;
  for (const uint32_t t : triangles) {
    const double area = mesh.area(t) / 3;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const uint32_t p = mesh.corners[t][corner];
      uint32_t& cluster = result.of_position[p];
      if (cluster == no_index) {
        uint64_t key = facing(normals[p]);
        for (int axis = 0; axis < 3; ++axis)
          key = hash_combine(
              key, static_cast<uint64_t>(static_cast<int64_t>(std::floor(mesh.positions[p][axis] / cell))));
        const auto [entry, fresh] = index.emplace(key, static_cast<uint32_t>(result.all.size()));
        if (fresh) result.all.emplace_back();
        cluster = entry->second;
      }
      Cluster& c = result.all[cluster];
      const Rgb& a = albedo[mesh.attributes[t][corner]];
      c.centre += area * mesh.positions[p];
      c.albedo += area * Vec3(a.r, a.g, a.b);
      c.area += area;
    }
  }
  for (Cluster& c : result.all)
    if (c.area > 0) c.centre /= c.area;
  result.neighbours.resize(result.all.size());
  for (const uint32_t t : triangles)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const uint32_t a = result.of_position[mesh.corners[t][corner]];
      const uint32_t b = result.of_position[mesh.corners[t][(corner + 1) % 3]];
      if (a == b) continue;
      result.neighbours[a].push_back(b);
      result.neighbours[b].push_back(a);
    }
  for (auto& list : result.neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return result;
}

// What one thread needs to walk over clusters.
struct Walk {
  explicit Walk(std::size_t clusters) : visited_by(clusters, no_index), path(clusters) {}
  std::vector<uint32_t> queue, visited_by;
  std::vector<float> path;  // length of the way a cluster was reached by
};

// The Gaussian average around a point over the clusters that hang together with the first one. A cluster that
// is near in space but far along the surface (the other side of a sheet) does not count.
Vec3f average(const Clusters& clusters, const Vec3& point, uint32_t first, double sigma, Walk& walk,
              uint32_t stamp) {
  const double variance =
      sigma * sigma * (1 - cluster_size * cluster_size / 12);  // a cluster has a width itself
  walk.queue.assign(1, first);
  walk.visited_by[first] = stamp;
  walk.path[first] = 0;
  Vec3 sum(0);
  double weight = 0;
  for (std::size_t head = 0; head < walk.queue.size(); ++head) {
    const uint32_t here = walk.queue[head];
    const Cluster& c = clusters.all[here];
    const double distance = glm::distance(c.centre, point), path = static_cast<double>(walk.path[here]);
    if (head > 0 && (distance > reach * sigma || path > detour * distance + sigma)) continue;
    const double w = std::exp(-0.5 * distance * distance / variance);
    sum += w * c.albedo;
    weight += w * c.area;
    for (const uint32_t next : clusters.neighbours[here])
      if (walk.visited_by[next] != stamp) {
        walk.visited_by[next] = stamp;
        walk.path[next] = static_cast<float>(path + glm::distance(c.centre, clusters.all[next].centre));
        walk.queue.push_back(next);
      }
  }
  const Cluster& own = clusters.all[first];
  if (weight > 0) return Vec3f(sum / weight);
  return own.area > 0 ? Vec3f(own.albedo / own.area) : Vec3f(0);
}

std::vector<Vec3f> average_everywhere(const TriangleMesh& mesh, const Clusters& clusters, double sigma) {
  std::vector<Vec3f> values(mesh.positions.size(), Vec3f(0));
  parallel_for(values.size(), 4096, [&](std::size_t begin, std::size_t end) {
    Walk walk(clusters.all.size());
    for (std::size_t p = begin; p < end; ++p)
      if (clusters.of_position[p] != no_index)
        values[p] = average(clusters, mesh.positions[p], clusters.of_position[p], sigma, walk,
                            static_cast<uint32_t>(p));
  });
  return values;
}

double mean_edge(const TriangleMesh& mesh, std::span<const uint32_t> triangles) {
  double sum = 0;
  for (const uint32_t t : triangles)
    for (std::size_t corner = 0; corner < 3; ++corner)
      sum += glm::distance(mesh.positions[mesh.corners[t][corner]],
                           mesh.positions[mesh.corners[t][(corner + 1) % 3]]);
  return triangles.empty() ? 0 : sum / (3.0 * static_cast<double>(triangles.size()));
}

}  // namespace

VertexAlbedo::VertexAlbedo(const TriangleMesh& mesh, std::span<const uint32_t> triangles,
                           std::vector<Rgb> albedo)
    : mesh_(mesh), albedo_(std::move(albedo)), finest_(mean_edge(mesh, triangles)) {
  for (const uint32_t t : triangles)
    for (const uint32_t attribute : mesh.attributes[t])
      for (int c = 0; c < 3; ++c) max_[c] = std::max(max_[c], albedo_[attribute][c]);
  if (!(finest_ > 0)) return;
  const std::vector<Vec3> normals = position_normals(mesh, triangles);
  const double widest = bounding_box(mesh).diagonal();
  for (double sigma = finest_; levels_.empty() || sigma < widest; sigma *= 2)
    levels_.push_back(average_everywhere(
        mesh, make_clusters(mesh, triangles, normals, albedo_, cluster_size * sigma), sigma));
}

Rgb VertexAlbedo::at(uint32_t triangle, Vec2 b) const {
  const Index3& corner = mesh_.attributes[triangle];
  return (1 - b.x - b.y) * albedo_[corner[0]] + b.x * albedo_[corner[1]] + b.y * albedo_[corner[2]];
}

Rgb VertexAlbedo::level_value(std::size_t level, uint32_t triangle, Vec2 b) const {
  const Index3& corner = mesh_.corners[triangle];
  const std::vector<Vec3f>& values = levels_[level];
  const Vec3 v = (1 - b.x - b.y) * Vec3(values[corner[0]]) + b.x * Vec3(values[corner[1]]) +
                 b.y * Vec3(values[corner[2]]);
  return {v.x, v.y, v.z};
}

Rgb VertexAlbedo::filtered(const KernelFootprint& footprint) const {
  const uint32_t triangle = footprint.triangle;
  // Narrow Gaussians may lie in the triangle's plane beside it.
  Vec2 b = glm::max(footprint.barycentric, 0.0);
  b /= std::max(b.x + b.y, 1.0);
  if (levels_.empty() || !(footprint.sigma > 0)) return at(triangle, b);
  const double ratio = footprint.sigma / finest_, last = static_cast<double>(levels_.size() - 1);
  if (ratio < 1) {
    const double share = ratio * ratio;
    return (1 - share) * at(triangle, b) + share * level_value(0, triangle, b);
  }
  const double place = std::log2(ratio);
  if (!(place < last)) return level_value(levels_.size() - 1, triangle, b);
  const auto below = static_cast<std::size_t>(place);
  const double low = std::exp2(static_cast<double>(below));
  const double share = (ratio * ratio / (low * low) - 1) / 3;  // by variance
  return (1 - share) * level_value(below, triangle, b) + share * level_value(below + 1, triangle, b);
}

}  // namespace alabaster
