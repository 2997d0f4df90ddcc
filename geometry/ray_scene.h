#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/vec.h"
#include "geometry/mesh.h"

namespace alabaster {

struct Ray {
  Vec3 origin{0};     // m
  Vec3 direction{0};  // need not be unit; t counts in its lengths
  double t_min = 0;
  double t_max = std::numeric_limits<double>::infinity();
  /// A triangle the ray leaves from, which it must not hit again at once.
  uint32_t ignore_object = no_index, ignore_triangle = no_index;
};

struct Hit {
  double t = 0;
  Vec2 barycentric{0};  // weights of the second and third corner
  uint32_t object = 0, triangle = 0;
};

struct ClosestPoint {
  Vec3 position{0};
  Vec2 barycentric{0};
  uint32_t triangle = 0;
  double distance = 0;
};

/// Decides whether a hit counts (alphaMode MASK and BLEND). Called during traversal, from many threads.
/// `random` is what the caller of the query gave, for stochastic opacity.
using HitFilter = std::function<bool(uint32_t triangle, Vec2 barycentric, double random)>;

/// All rays of the program go through here: the one place that knows Embree. Queries are thread-safe after
/// commit().
class RayScene {
 public:
  RayScene();
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// Adds an object; ids count from 0. The mesh must outlive the scene. An empty filter means opaque.
  uint32_t add(const TriangleMesh& mesh, HitFilter filter = {});
  void commit();

  std::optional<Hit> nearest(const Ray& ray, double random = 0) const;
  bool occluded(const Ray& ray, double random = 0) const;
  /// Every hit with one object along the segment, front and back faces, in one traversal, unsorted; where
  /// the ray crosses the surface on an edge or corner that triangles share, that is one hit. `hits` is
  /// cleared first; its capacity is reused.
  void all_hits(uint32_t object, const Ray& ray, std::vector<Hit>& hits, double random = 0) const;
  /// The closest point of one object's surface within `radius`; nothing if there is none. A triangle that is
  /// probably close saves time and changes nothing.
  std::optional<ClosestPoint> closest_point(uint32_t object, const Vec3& p,
                                            double radius = std::numeric_limits<double>::infinity(),
                                            uint32_t guess = no_index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace alabaster
