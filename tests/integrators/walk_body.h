#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "integrators/volume_walk.h"
#include "optics/photon_walk.h"

namespace alabaster::test {

class EqualAlbedo final : public AlbedoField {
 public:
  explicit EqualAlbedo(Rgb value) : value_(value) {}
  Rgb at(const SurfacePoint&) const override { return value_; }
  Rgb filtered(const KernelFootprint&) const override { return value_; }
  Rgb max() const override { return value_; }

 private:
  Rgb value_;
};

/// Stripes across x and slow waves along y and z, by the position on the surface.
class StripedAlbedo final : public AlbedoField {
 public:
  StripedAlbedo(const TriangleMesh& mesh, double period) : mesh_(mesh), period_(period) {}
  Rgb at(const SurfacePoint& point) const override {
    const Vec3 p = mesh_.position(point.triangle, point.barycentric) / period_;
    const double stripe = p.x - std::floor(p.x) < 0.5 ? 1 : 0.7;
    return {0.97 * stripe, stripe * (0.8 + 0.15 * std::sin(p.y)), 0.75 + 0.2 * std::sin(2 * p.z)};
  }
  Rgb filtered(const KernelFootprint&) const override { return Rgb(1); }
  Rgb max() const override { return Rgb(0.97); }

 private:
  const TriangleMesh& mesh_;
  double period_;
};

struct Body {
  TriangleMesh mesh;
  RayScene rays;
  std::vector<double> cumulative_area;

  explicit Body(TriangleMesh made) : mesh(std::move(made)) {
    rays.add(mesh);
    rays.commit();
    double sum = 0;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) cumulative_area.push_back(sum += mesh.area(t));
  }

  SurfacePoint uniform_point(Rng& rng) const {
    const double u = rng.uniform() * cumulative_area.back();
    const auto found = std::upper_bound(cumulative_area.begin(), cumulative_area.end(), u);
    const auto triangle = static_cast<uint32_t>(std::min<std::ptrdiff_t>(
        found - cumulative_area.begin(), static_cast<std::ptrdiff_t>(cumulative_area.size()) - 1));
    const double s = std::sqrt(rng.uniform()), v = rng.uniform();
    return mesh.surface_point(triangle, {s * (1 - v), s * v});
  }
};

struct Returned {
  RunningMoments scattered[3], unscattered[3];
};

// Light that entered under uniform diffuse radiance, and came back: what scattered, and what did not.
inline Returned returned(const Body& body, const VolumeWalk& walk, int walks, uint64_t seed) {
  Returned result;
  Rng rng(seed);
  for (int i = 0; i < walks; ++i) {
    const SurfacePoint start = body.uniform_point(rng);
    const Vec3 direction = Frame(-start.geometric_normal).to_world(sample_diffuse_entry(1.5, rng));
    const auto end = walk.walk(start, direction, rng);
    for (int c = 0; c < 3; ++c) {
      result.scattered[c].add(end && end->order > 0 ? end->weight[c] : 0);
      result.unscattered[c].add(end && end->order == 0 ? end->weight[c] : 0);
    }
  }
  return result;
}

inline VolumeWalk walk_in(const Body& body, const Medium& medium, const AlbedoField& albedo,
                          VolumeWalkOptions options = {}) {
  return VolumeWalk(body.rays, body.mesh, 0, {1}, medium, albedo, options);
}

/// Of two independent means.
inline double z_of(const RunningMoments& a, const RunningMoments& b) {
  return (a.mean() - b.mean()) / std::sqrt(a.variance_of_mean() + b.variance_of_mean());
}

}  // namespace alabaster::test
