#include <algorithm>
#include <array>
#include <limits>
#include <queue>
#include <unordered_map>

#include "geometry/geodesic.h"

namespace alabaster {

namespace {

class EdgeGraph final : public Geodesic {
 public:
  EdgeGraph(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges);
  std::string_view name() const override { return "edge graph"; }
  std::optional<double> distance(const SurfacePoint& from, const SurfacePoint& to) const override;

 private:
  struct Ends {
    std::array<uint32_t, 3> vertex;
    std::array<double, 3> distance;
  };
  Ends ends(const SurfacePoint& point) const;

  std::vector<Index3> vertices_;     // by triangle
  std::vector<Vec3> positions_;      // by vertex
  std::vector<uint32_t> begin_;      // of a vertex's neighbours
  std::vector<uint32_t> neighbour_;  // by vertex
};

EdgeGraph::EdgeGraph(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges)
    : vertices_(mesh.triangle_count()), positions_(half_edges.vertex_count()), begin_{0} {
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) vertices_[t][static_cast<std::size_t>(k)] = half_edges.vertex(t, k);
  std::vector<uint32_t> ring;
  for (uint32_t v = 0; v < positions_.size(); ++v) {
    positions_[v] = mesh.positions[half_edges.position_of(v)];
    half_edges.ring(v, ring);
    neighbour_.insert(neighbour_.end(), ring.begin(), ring.end());
    begin_.push_back(static_cast<uint32_t>(neighbour_.size()));
  }
}

EdgeGraph::Ends EdgeGraph::ends(const SurfacePoint& point) const {
  Ends ends{vertices_[point.triangle], {}};
  for (std::size_t k = 0; k < 3; ++k)
    ends.distance[k] = glm::length(positions_[ends.vertex[k]] - point.position);
  return ends;
}

std::optional<double> EdgeGraph::distance(const SurfacePoint& from, const SurfacePoint& to) const {
  if (from.triangle == to.triangle) return glm::length(to.position - from.position);
  struct Entry {
    double bound, walked;  // length so far plus the straight rest, and length so far
    uint32_t vertex;
    bool operator<(const Entry& o) const { return bound > o.bound; }  // shortest first
  };
  std::priority_queue<Entry> queue;
  std::unordered_map<uint32_t, double> walked;
  const auto reach = [&](uint32_t vertex, double length) {
    const auto [place, fresh] = walked.emplace(vertex, length);
    if (!fresh && length >= place->second) return;
    place->second = length;
    queue.push({length + glm::length(to.position - positions_[vertex]), length, vertex});
  };
  const Ends start = ends(from), goal = ends(to);
  for (std::size_t k = 0; k < 3; ++k) reach(start.vertex[k], start.distance[k]);
  double best = std::numeric_limits<double>::infinity();
  while (!queue.empty() && queue.top().bound < best) {
    const Entry entry = queue.top();
    queue.pop();
    if (entry.walked > walked.at(entry.vertex)) continue;  // a shorter way was found meanwhile
    for (std::size_t k = 0; k < 3; ++k)
      if (goal.vertex[k] == entry.vertex) best = std::min(best, entry.walked + goal.distance[k]);
    for (uint32_t i = begin_[entry.vertex]; i < begin_[entry.vertex + 1]; ++i)
      reach(neighbour_[i], entry.walked + glm::length(positions_[neighbour_[i]] - positions_[entry.vertex]));
  }
  if (best == std::numeric_limits<double>::infinity()) return std::nullopt;
  return best;
}

}  // namespace

std::unique_ptr<Geodesic> make_edge_graph(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges) {
  return std::make_unique<EdgeGraph>(mesh, half_edges);
}

}  // namespace alabaster
