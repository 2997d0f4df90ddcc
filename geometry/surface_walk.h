#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/mesh.h"

namespace alabaster {

/// Where a walk over a surface is, and where it heads (unit, in the triangle's plane).
struct SurfaceWalker {
  uint32_t triangle = 0;
  Vec3 position{0}, direction{0};
  double walked = 0;  // m
};

/// Goes straight on, each triangle unfolded into the plane of the one before (Polthier and Schmies 1998),
/// until `length` metres are walked in all or a border is reached. `across(triangle, k)` is the neighbour
/// beyond the edge from corner k to k + 1, or no_index.
template <class Across>
SurfaceWalker walk_straight(const TriangleMesh& mesh, const Across& across, SurfaceWalker walker,
                            double length) {
  // A path of a kernel's size crosses tens of triangles; one that crosses these many goes round in circles.
  constexpr int max_triangles = 20000;
  std::size_t entered_by = 3;
  for (int i = 0; i < max_triangles; ++i) {
    const Index3& index = mesh.corners[walker.triangle];
    const std::array<Vec3, 3> corner{mesh.positions[index[0]], mesh.positions[index[1]],
                                     mesh.positions[index[2]]};
    const Vec3 normal = mesh.geometric_normal(walker.triangle);
    double nearest = length - walker.walked;
    std::size_t exit = 3;
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == entered_by) continue;
      const Vec3 inwards = glm::cross(normal, corner[(k + 1) % 3] - corner[k]);
      const double speed = -glm::dot(walker.direction, inwards);
      if (!(speed > 0)) continue;
      const double s = std::max(glm::dot(walker.position - corner[k], inwards), 0.0) / speed;
      if (s < nearest) nearest = s, exit = k;
    }
    walker.position += nearest * walker.direction;
    walker.walked += nearest;
    if (exit == 3) return walker;  // arrived
    const uint32_t next = across(walker.triangle, static_cast<int>(exit));
    if (next == no_index) return walker;
    const uint32_t from = index[exit], to = index[(exit + 1) % 3];
    const Vec3 edge = glm::normalize(mesh.positions[to] - mesh.positions[from]);
    const Index3& other = mesh.corners[next];
    for (std::size_t k = 0; k < 3; ++k)
      if (other[k] != from && other[k] != to) entered_by = (k + 1) % 3;
    const Vec3 opposite = mesh.positions[other[(entered_by + 2) % 3]] - mesh.positions[from];
    const Vec3 into = glm::normalize(opposite - edge * glm::dot(edge, opposite));
    const double along = glm::dot(walker.direction, edge);
    walker.direction = along * edge + std::sqrt(std::max(1 - along * along, 0.0)) * into;
    walker.triangle = next;
  }
  return walker;
}

}  // namespace alabaster
