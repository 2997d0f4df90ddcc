#pragma once

#include <numeric>
#include <vector>

#include "geometry/mesh.h"

struct UvTriangle {
  alabaster::Vec2 a, b, c;
};

/// Separate triangles whose positions are their UVs in metres, in the plane z = 0.
inline alabaster::TriangleMesh uv_mesh(const std::vector<UvTriangle>& triangles) {
  using namespace alabaster;
  TriangleMesh mesh;
  mesh.uv_sets.emplace_back();
  mesh.normals = {{0, 0, 1}};
  for (const UvTriangle& corners : triangles) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const Vec2& uv : {corners.a, corners.b, corners.c}) {
      mesh.positions.emplace_back(uv.x, uv.y, 0);
      mesh.uv_sets[0].emplace_back(uv);
    }
    mesh.corners.push_back({first, first + 1, first + 2});
    mesh.attributes.push_back({first, first + 1, first + 2});
    mesh.materials.push_back(0);
  }
  mesh.normals.assign(mesh.positions.size(), alabaster::Vec3f(0, 0, 1));
  return mesh;
}

inline std::vector<uint32_t> all_triangles(const alabaster::TriangleMesh& mesh) {
  std::vector<uint32_t> result(mesh.triangle_count());
  std::iota(result.begin(), result.end(), 0u);
  return result;
}
