#pragma once

#include <cmath>

#include "core/vec.h"

namespace alabaster {

/// Right-handed orthonormal frame around a unit normal. The branchless construction is that of
/// Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
struct Frame {
  Vec3 tangent, bitangent, normal;

  explicit Frame(const Vec3& n) : normal(n) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    tangent = {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }

  Vec3 to_world(const Vec3& v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
  Vec3 to_local(const Vec3& v) const {
    return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)};
  }
};

/// A direction around a unit normal with density cos / pi, u in [0, 1).
inline Vec3 cosine_direction(const Vec3& normal, Vec2 u) {
  const double r = std::sqrt(u.x), phi = 2 * pi * u.y;
  return Frame(normal).to_world({r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u.x)});
}

}  // namespace alabaster
