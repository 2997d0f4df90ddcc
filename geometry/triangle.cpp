#include "geometry/triangle.h"

namespace alabaster {

namespace {

/// Parameter in [0, 1] of the point of the segment from p to q that is closest to the origin.
double closest_on_segment(const Vec3& p, const Vec3& q) {
  const Vec3 edge = q - p;
  const double squared = length_squared(edge);
  return squared > 0 ? std::clamp(-glm::dot(p, edge) / squared, 0.0, 1.0) : 0.0;
}

}  // namespace

Vec2 Triangle::closest(const Vec3& p) const {
  const Vec3 pa = a - p, pb = b - p, pc = c - p;
  const Vec3 n = glm::cross(b - a, c - a);
  const double squared = length_squared(n);
  // Areas of the triangles that p's foot makes with each edge, as weights of the opposite corner.
  if (squared > 0) {
    const double weight_b = glm::dot(n, glm::cross(pc, pa)) / squared;
    const double weight_c = glm::dot(n, glm::cross(pa, pb)) / squared;
    if (weight_b >= 0 && weight_c >= 0 && weight_b + weight_c <= 1) return {weight_b, weight_c};
  }
  // The foot lies outside: the closest point is on one of the edges.
  const double ab = closest_on_segment(pa, pb), bc = closest_on_segment(pb, pc),
               ca = closest_on_segment(pc, pa);
  const double to_ab = length_squared(pa + ab * (pb - pa));
  const double to_bc = length_squared(pb + bc * (pc - pb));
  const double to_ca = length_squared(pc + ca * (pa - pc));
  if (to_ab <= to_bc && to_ab <= to_ca) return {ab, 0};
  if (to_bc <= to_ca) return {1 - bc, bc};
  return {0, 1 - ca};
}

}  // namespace alabaster
