#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/mesh.h"

/// Adaptive quadrature over triangles: the brute force that sampling is tested against. f(triangle,
/// barycentric) is integrated by area to about `tolerance` (absolute, per triangle of the mesh).
template <class F>
class TriangleIntegral {
 public:
  TriangleIntegral(const alabaster::TriangleMesh& mesh, const F& f, double tolerance)
      : mesh_(mesh), f_(f), tolerance_(tolerance) {}

  double over(uint32_t triangle) const {
    const Corners whole{{{0, 0}, {1, 0}, {0, 1}}};
    const double area = mesh_.area(triangle);
    return refine(triangle, whole, area, rule(triangle, whole, area), 0);
  }
  double over_all() const {
    double sum = 0;
    for (uint32_t t = 0; t < mesh_.triangle_count(); ++t) sum += over(t);
    return sum;
  }

 private:
  using Corners = std::array<alabaster::Vec2, 3>;

  // Exact to second order (Strang and Fix), points inside.
  double rule(uint32_t triangle, const Corners& c, double area) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k)
      sum += f_(triangle, (c[0] + c[1] + c[2] + 3.0 * c[static_cast<std::size_t>(k)]) / 6.0);
    return area * sum / 3;
  }
  double refine(uint32_t triangle, const Corners& c, double area, double coarse, int depth) const {
    const alabaster::Vec2 ab = 0.5 * (c[0] + c[1]), bc = 0.5 * (c[1] + c[2]), ca = 0.5 * (c[2] + c[0]);
    const std::array<Corners, 4> parts{{{c[0], ab, ca}, {ab, c[1], bc}, {ca, bc, c[2]}, {ab, bc, ca}}};
    std::array<double, 4> fine{};
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += fine[k] = rule(triangle, parts[k], area / 4);
    if (depth >= 22 || (depth >= 1 && std::abs(sum - coarse) < tolerance_)) return sum;
    double total = 0;
    for (std::size_t k = 0; k < 4; ++k) total += refine(triangle, parts[k], area / 4, fine[k], depth + 1);
    return total;
  }

  const alabaster::TriangleMesh& mesh_;
  const F& f_;
  double tolerance_;
};
