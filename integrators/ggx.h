#pragma once

#include <algorithm>
#include <cmath>

#include "core/vec.h"

namespace alabaster {

/// The GGX distribution of microfacets with Smith masking, isotropic. Directions are local (z is the normal)
/// and unit. `alpha` is the square of glTF's roughness; below `smooth` a surface counts as a mirror.
struct Ggx {
  static constexpr double smooth = 1e-3;
  double alpha;

  bool is_smooth() const { return alpha < smooth; }

  /// Density of microfacet normals (Walter et al. 2007, eq. 33).
  double distribution(const Vec3& h) const {
    if (h.z <= 0) return 0;
    const double a2 = alpha * alpha, k = h.z * h.z * (a2 - 1) + 1;
    return a2 / (pi * k * k);
  }

  /// Smith's Lambda (Heitz 2014, eq. 72).
  double lambda(const Vec3& w) const {
    const double z2 = w.z * w.z;
    return z2 == 0 ? 1e12 : (std::sqrt(1 + alpha * alpha * std::max(0.0, 1 - z2) / z2) - 1) / 2;
  }
  double masking(const Vec3& w) const { return 1 / (1 + lambda(w)); }
  /// Height-correlated masking and shadowing (Heitz 2014, eq. 99).
  double masking_shadowing(const Vec3& wo, const Vec3& wi) const { return 1 / (1 + lambda(wo) + lambda(wi)); }

  /// Draws a microfacet normal as seen from `wo`, wo.z > 0 (Heitz 2018, "Sampling the GGX Distribution of
  /// Visible Normals").
  Vec3 sample_visible_normal(const Vec3& wo, Vec2 u) const {
    const Vec3 v = glm::normalize(Vec3(alpha * wo.x, alpha * wo.y, wo.z));
    const double length2 = v.x * v.x + v.y * v.y;
    const Vec3 t1 = length2 > 0 ? Vec3(-v.y, v.x, 0) / std::sqrt(length2) : Vec3(1, 0, 0);
    const Vec3 t2 = glm::cross(v, t1);
    const double r = std::sqrt(u.x), phi = 2 * pi * u.y, s = 0.5 * (1 + v.z);
    const double p1 = r * std::cos(phi);
    const double p2 = (1 - s) * std::sqrt(1 - p1 * p1) + s * r * std::sin(phi);
    const Vec3 n = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0, 1 - p1 * p1 - p2 * p2)) * v;
    return glm::normalize(Vec3(alpha * n.x, alpha * n.y, std::max(0.0, n.z)));
  }

  /// Density per solid angle of the direction that sample_visible_normal() mirrors `wo` into; both above the
  /// surface.
  double pdf_reflection(const Vec3& wo, const Vec3& wi) const {
    const Vec3 h = glm::normalize(wo + wi);
    return masking(wo) * distribution(h) / (4 * wo.z);
  }
};

}  // namespace alabaster
