#pragma once

#include <cmath>
#include <limits>

#include "core/vec.h"
#include "geometry/mesh.h"

// Small meshes that break careless code. Attributes are the corners, UV set 0 is planar unless said.
namespace nasty {

using alabaster::Index3;
using alabaster::TriangleMesh;
using alabaster::Vec3;

inline TriangleMesh from(std::vector<Vec3> positions, std::vector<Index3> corners) {
  TriangleMesh mesh;
  mesh.positions = std::move(positions);
  mesh.corners = std::move(corners);
  mesh.attributes = mesh.corners;
  mesh.materials.assign(mesh.corners.size(), 0);
  mesh.uv_sets.resize(1);
  for (const Vec3& p : mesh.positions) {
    mesh.normals.emplace_back(0.0f, 0.0f, 1.0f);
    mesh.uv_sets[0].emplace_back(p);
  }
  return mesh;
}

inline TriangleMesh single_triangle() {
  return from({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
}

inline TriangleMesh tetrahedron() {
  return from({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
}

/// n squares around a ring with a half turn: one border, one side.
inline TriangleMesh moebius(uint32_t n = 12) {
  std::vector<Vec3> positions;
  for (uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * alabaster::pi * i / n, half = angle / 2;
    for (const double w : {-0.3, 0.3})
      positions.push_back({(1 + w * std::cos(half)) * std::cos(angle),
                           (1 + w * std::cos(half)) * std::sin(angle), w * std::sin(half)});
  }
  std::vector<Index3> corners;
  for (uint32_t i = 0; i < n; ++i) {
    const bool seam = i + 1 == n;
    const uint32_t a = 2 * i, b = a + 1, c = seam ? 1 : a + 2, d = seam ? 0 : a + 3;
    corners.push_back({a, c, b});
    corners.push_back({b, c, d});
  }
  return from(std::move(positions), std::move(corners));
}

/// Three leaves at one edge.
inline TriangleMesh book() {
  return from({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
}

/// Two tetrahedra that share the edge from corner 0 to corner 3.
inline TriangleMesh two_at_an_edge() {
  TriangleMesh t = tetrahedron();
  std::vector<Vec3> positions = t.positions;
  positions.push_back({-1, 0, 0});
  positions.push_back({0, -1, 0});
  std::vector<Index3> corners = t.corners;  // 1 -> 4, 2 -> 5: turned by half a turn around z
  for (const Index3& c : t.corners) {
    Index3 turned = c;
    for (uint32_t& i : turned) i = i == 1 ? 4 : i == 2 ? 5 : i;
    corners.push_back(turned);
  }
  return from(std::move(positions), std::move(corners));
}

/// Two fans that share nothing but a corner.
inline TriangleMesh bow_tie() {
  return from({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
}

}  // namespace nasty
