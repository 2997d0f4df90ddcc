#include <algorithm>
#include <array>
#include <limits>
#include <queue>
#include <unordered_map>

#include "geometry/geodesic.h"

namespace alabaster {

namespace {

constexpr double unreached = std::numeric_limits<double>::infinity();

/// Nodes are the corners and `per_edge` points on every edge; within a triangle all are connected.
class SteinerGraph final : public Geodesic {
 public:
  SteinerGraph(const TriangleMesh& mesh, int per_edge);
  std::string_view name() const override { return "Steiner graph"; }
  std::optional<double> distance(const SurfacePoint& from, const SurfacePoint& to) const override {
    return distances(from, {&to, 1}).front();
  }
  std::vector<std::optional<double>> distances(const SurfacePoint& from,
                                               std::span<const SurfacePoint> to) const override;

 private:
  std::span<const uint32_t> nodes(uint32_t triangle) const {
    return {nodes_.data() + triangle * per_triangle_, per_triangle_};
  }
  std::span<const uint32_t> triangles(uint32_t node) const {
    return {triangles_.data() + begin_[node], begin_[node + 1] - begin_[node]};
  }

  std::size_t per_triangle_;
  std::vector<Vec3> positions_;  // of nodes
  std::vector<uint32_t> nodes_;  // of triangles
  std::vector<uint32_t> begin_;  // of a node's triangles
  std::vector<uint32_t> triangles_;
};

SteinerGraph::SteinerGraph(const TriangleMesh& mesh, int per_edge)
    : per_triangle_(3 + 3 * static_cast<std::size_t>(per_edge)), positions_(mesh.positions) {
  std::unordered_map<uint64_t, uint32_t> first_on_edge;
  for (const Index3& corner : mesh.corners) {
    nodes_.insert(nodes_.end(), corner.begin(), corner.end());
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(corner[k], corner[(k + 1) % 3]);
      const auto [entry, fresh] =
          first_on_edge.emplace((uint64_t{low} << 32) | high, static_cast<uint32_t>(positions_.size()));
      for (int i = 0; i < per_edge; ++i) {
        if (fresh)
          positions_.push_back(
              glm::mix(mesh.positions[low], mesh.positions[high], (i + 1.0) / (per_edge + 1.0)));
        nodes_.push_back(entry->second + static_cast<uint32_t>(i));
      }
    }
  }
  begin_.assign(positions_.size() + 1, 0);
  for (const uint32_t node : nodes_) ++begin_[node + 1];
  for (std::size_t n = 0; n < positions_.size(); ++n) begin_[n + 1] += begin_[n];
  triangles_.resize(nodes_.size());
  std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    triangles_[next[nodes_[i]]++] = static_cast<uint32_t>(i / per_triangle_);
}

/// Dijkstra 1959 from one point until every target is certain.
std::vector<std::optional<double>> SteinerGraph::distances(const SurfacePoint& from,
                                                           std::span<const SurfacePoint> to) const {
  std::vector<double> best(to.size(), unreached), walked(positions_.size(), unreached);
  std::unordered_multimap<uint32_t, std::size_t> targets;  // by triangle
  for (std::size_t i = 0; i < to.size(); ++i) {
    targets.emplace(to[i].triangle, i);
    if (to[i].triangle == from.triangle) best[i] = glm::distance(from.position, to[i].position);
  }
  using Entry = std::pair<double, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const uint32_t node : nodes(from.triangle))
    queue.emplace(walked[node] = glm::distance(from.position, positions_[node]), node);
  while (!queue.empty()) {
    const auto [length, node] = queue.top();
    queue.pop();
    if (length > walked[node]) continue;
    if (std::all_of(best.begin(), best.end(), [length = length](double b) { return b <= length; })) break;
    for (const uint32_t triangle : triangles(node)) {
      const auto [first, last] = targets.equal_range(triangle);
      for (auto t = first; t != last; ++t)
        best[t->second] =
            std::min(best[t->second], length + glm::distance(positions_[node], to[t->second].position));
      for (const uint32_t other : nodes(triangle)) {
        const double longer = length + glm::distance(positions_[node], positions_[other]);
        if (longer < walked[other]) queue.emplace(walked[other] = longer, other);
      }
    }
  }
  std::vector<std::optional<double>> result(to.size());
  for (std::size_t i = 0; i < to.size(); ++i)
    if (best[i] < unreached) result[i] = best[i];
  return result;
}

}  // namespace

std::unique_ptr<Geodesic> make_steiner_graph(const TriangleMesh& mesh, int per_edge) {
  return std::make_unique<SteinerGraph>(mesh, per_edge);
}

}  // namespace alabaster
