#include "geometry/mesh_edges.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace alabaster {

std::vector<TriangleSide> sorted_sides(const TriangleMesh& mesh) {
  // Counting sort by the lower end, then each bucket (a handful) by the upper: linear, and no bigger than
  // the sides themselves.
  std::vector<uint32_t> begin(mesh.positions.size() + 1, 0);
  const auto for_each_side = [&](auto&& visit) {
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
      for (uint8_t k = 0; k < 3; ++k) {
        const uint32_t from = mesh.corners[t][k], to = mesh.corners[t][(k + 1) % 3];
        if (from != to) visit(TriangleSide{std::min(from, to), std::max(from, to), t, k, from < to});
      }
  };
  for_each_side([&](const TriangleSide& side) { ++begin[side.low + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<TriangleSide> sides(begin.back());
  std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
  for_each_side([&](const TriangleSide& side) { sides[next[side.low]++] = side; });
  for (std::size_t v = 0; v + 1 < begin.size(); ++v)
    std::sort(sides.begin() + begin[v], sides.begin() + begin[v + 1],
              [](const TriangleSide& a, const TriangleSide& b) {
                return std::tie(a.high, a.triangle, a.side) < std::tie(b.high, b.triangle, b.side);
              });
  return sides;
}

DisjointSets::DisjointSets(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0u);
}

uint32_t DisjointSets::find(uint32_t i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void DisjointSets::unite(uint32_t i, uint32_t j) {
  i = find(i), j = find(j);
  if (i != j) parent_[std::max(i, j)] = std::min(i, j);
}

std::size_t DisjointSets::number(std::vector<uint32_t>& number_of) {
  number_of.resize(parent_.size());
  uint32_t count = 0;
  // The representative is the lowest member, so its number is known when the others are reached.
  for (uint32_t i = 0; i < parent_.size(); ++i) {
    const uint32_t root = find(i);
    number_of[i] = root == i ? count++ : number_of[root];
  }
  return count;
}

}  // namespace alabaster
