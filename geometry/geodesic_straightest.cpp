#include <algorithm>
#include <cmath>

#include "geometry/geodesic.h"
#include "geometry/surface_walk.h"
#include "geometry/triangle.h"

namespace alabaster {

namespace {

class StraightestPath final : public GeodesicPath {
 public:
  StraightestPath(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges)
      : mesh_(mesh), half_edges_(half_edges) {}
  std::string_view name() const override { return "straightest path"; }

  std::optional<double> distance(const SurfacePoint& from, const SurfacePoint& to) const override {
    const auto shot = aim(from, to);
    if (!shot) return std::nullopt;
    return shot->length + shot->miss;
  }

  std::optional<SurfacePoint> between(const SurfacePoint& from, const SurfacePoint& to,
                                      double t) const override {
    const auto shot = aim(from, to);
    if (!shot) return std::nullopt;
    const SurfaceWalker walker = walk({from.triangle, from.position, shot->direction, 0}, t * shot->length);
    const Triangle triangle = corners(walker.triangle);
    SurfacePoint point = mesh_.surface_point(walker.triangle, triangle.closest(walker.position));
    point.object = from.object;
    return point;
  }

 private:
  struct Shot {
    Vec3 direction{0};  // at the start
    double length = 0;
    double miss = 0;  // distance of the path's end from the target
  };

  Triangle corners(uint32_t t) const {
    const Index3& c = mesh_.corners[t];
    return {mesh_.positions[c[0]], mesh_.positions[c[1]], mesh_.positions[c[2]]};
  }

  SurfaceWalker walk(const SurfaceWalker& walker, double length) const {
    const auto across = [this](uint32_t triangle, int side) { return half_edges_.across(triangle, side); };
    return walk_straight(mesh_, across, walker, length);
  }
  std::optional<Shot> aim(const SurfacePoint& from, const SurfacePoint& to) const;

  static constexpr int max_corrections = 12;

  const TriangleMesh& mesh_;
  const HalfEdgeMesh& half_edges_;
};

std::optional<StraightestPath::Shot> StraightestPath::aim(const SurfacePoint& from,
                                                          const SurfacePoint& to) const {
  const Vec3 chord = to.position - from.position, normal = mesh_.geometric_normal(from.triangle);
  const double distance = glm::length(chord);
  if (!(distance > 0)) return Shot{};
  const Vec3 tangent = chord - normal * glm::dot(normal, chord);
  // Straight through the object: no direction to begin with.
  if (!(glm::length(tangent) > 1e-3 * distance)) return std::nullopt;
  Vec3 direction = glm::normalize(tangent);
  double length = distance;
  Shot best;
  best.miss = distance;
  for (int i = 0; i < max_corrections; ++i) {
    const SurfaceWalker end = walk({from.triangle, from.position, direction, 0}, length);
    const Vec3 rest = to.position - end.position;
    // Near the target but on a sheet that faces away from it is no arrival.
    const bool same_side = glm::dot(mesh_.geometric_normal(end.triangle), to.geometric_normal) > 0;
    const double miss = same_side ? glm::length(rest) : distance;
    if (miss < best.miss) best = {direction, end.walked, miss};
    if (miss < 1e-6 * distance || !(end.walked > 0)) break;
    // The end is moved along by walking farther and aside by turning the start (exact in the plane).
    const Vec3 aside = glm::cross(mesh_.geometric_normal(end.triangle), end.direction);
    length = std::clamp(end.walked + glm::dot(rest, end.direction), 0.1 * distance, 4 * distance);
    const double turn = std::clamp(std::atan2(glm::dot(rest, aside), end.walked), -0.5, 0.5);
    direction = glm::normalize(std::cos(turn) * direction + std::sin(turn) * glm::cross(normal, direction));
  }
  if (best.miss > 0.02 * distance) return std::nullopt;
  return best;
}

}  // namespace

std::unique_ptr<GeodesicPath> make_straightest_path(const TriangleMesh& mesh,
                                                    const HalfEdgeMesh& half_edges) {
  return std::make_unique<StraightestPath>(mesh, half_edges);
}

}  // namespace alabaster
