#pragma once

#include <algorithm>

#include "core/vec.h"

namespace alabaster {

/// Three corners, by value.
struct Triangle {
  Vec3 a, b, c;

  Vec3 point(Vec2 barycentric) const {
    return a * (1 - barycentric.x - barycentric.y) + b * barycentric.x + c * barycentric.y;
  }
  /// Twice the area times the normal.
  Vec3 area_vector() const { return glm::cross(b - a, c - a); }
  double longest_edge_squared() const {
    return std::max({length_squared(b - a), length_squared(c - b), length_squared(a - c)});
  }
  /// Barycentric weights (of b and c) of the point of the triangle that is closest to p. Degenerate triangles
  /// count as the segment or point they are.
  Vec2 closest(const Vec3& p) const;
};

}  // namespace alabaster
