#pragma once

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace alabaster {

/// A triangle's side from corner `side` to corner `side + 1`.
struct TriangleSide {
  uint32_t low, high;  // positions at the ends, low < high
  uint32_t triangle;
  uint8_t side;
  bool forward;  // runs from low to high

  bool same_edge(const TriangleSide& o) const { return low == o.low && high == o.high; }
};

/// All sides of all triangles whose ends differ, sorted so that the sides of one edge lie together, each
/// group in the order of triangles.
std::vector<TriangleSide> sorted_sides(const TriangleMesh& mesh);

/// Calls visit(first, last) for the sides [first, last) of each edge.
template <class Visit>
void for_each_edge(const std::vector<TriangleSide>& sides, Visit&& visit) {
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].same_edge(sides[first])) ++last;
    visit(sides.data() + first, sides.data() + last);
  }
}

/// Disjoint sets with path halving; the representative of a set is its lowest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count);
  uint32_t find(uint32_t i);
  void unite(uint32_t i, uint32_t j);
  /// Replaces representatives by numbers counted from 0 in order of first appearance; returns their count.
  std::size_t number(std::vector<uint32_t>& number_of);

 private:
  std::vector<uint32_t> parent_;
};

}  // namespace alabaster
