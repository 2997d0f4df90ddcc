#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "optics/path_tally.h"
#include "optics/photon_walk.h"

// Photon walks in the bodies whose transport depends on one size: balls, the surroundings of spherical
// cavities, slabs. Light enters at the origin, where the inward normal is +z. Optical units.

namespace alabaster {

/// The medium inside a ball of radius 1/curvature (curvature > 0), around a spherical cavity (< 0) or below
/// the plane z = 0 (0). A point is inside where depth() > 0.
struct CurvedBody {
  double curvature;

  /// Twice the depth below the surface, nearly; on a ball of radius R exactly R - |p - centre|^2 / R.
  double depth(const Vec3& p) const { return 2 * p.z - curvature * glm::dot(p, p); }
  /// depth() is a quadratic along the ray; of its two roots the one where the ray leaves, without
  /// cancellation.
  double boundary_distance(const Vec3& position, const Vec3& direction) const {
    const double f = std::max(depth(position), 0.0);
    const double slope = direction.z - curvature * glm::dot(position, direction);
    const double square = slope * slope + curvature * f;
    if (square < 0) return std::numeric_limits<double>::infinity();
    const double root = std::sqrt(square);
    if (slope < 0) return f / (root - slope);
    return curvature > 0 ? (slope + root) / curvature : std::numeric_limits<double>::infinity();
  }
  void snap(Photon& photon) const {
    photon.position += 0.5 * depth(photon.position) * outward(photon.position);
  }
  Vec3 outward_normal(const Vec3& position) const { return outward(position); }

 private:
  Vec3 outward(const Vec3& p) const { return glm::normalize(curvature * p - Vec3(0, 0, 1)); }
};

/// One of the bodies.
struct WalkBody {
  double curvature = 0;  // as CurvedBody; not for slabs
  double thickness = 0;  // > 0: a slab

  static WalkBody ball(double radius) { return {1 / radius, 0}; }
  static WalkBody cavity(double radius) { return {-1 / radius, 0}; }
  static WalkBody slab(double thickness) { return {0, thickness}; }
  bool is_slab() const { return thickness > 0; }
};

struct BodyWalkOptions {
  WalkMedium medium;
  uint64_t photons = 1000000;  // rounded up to whole chunks
  uint64_t seed = 1;
  WalkStages stages = {};
};

/// Tallies where photons of uniform incident radiance leave: by chord, on a slab by lateral distance on
/// either side. Vector lanes; depends on photons and seed alone.
PathTally body_tally(const WalkBody& body, const BodyWalkOptions& options);
/// The same by the scalar walk in double precision: the oracle.
PathTally body_tally_scalar(const WalkBody& body, const BodyWalkOptions& options);

}  // namespace alabaster
