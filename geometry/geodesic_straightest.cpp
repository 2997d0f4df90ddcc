#include <algorithm>
#include <cmath>

#include "geometry/geodesic.h"
#include "geometry/triangle.h"

namespace alabaster {

namespace {

/// Where a walk over the surface is, and where it heads (unit, in the triangle's plane).
struct Walker {
  uint32_t triangle = 0;
  Vec3 position{0}, direction{0};
  double walked = 0;
};

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
    const Walker walker = walk({from.triangle, from.position, shot->direction, 0}, t * shot->length);
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

  Walker walk(Walker walker, double length) const;
  std::optional<Shot> aim(const SurfacePoint& from, const SurfacePoint& to) const;

  // A path of a kernel's size crosses tens of triangles; one that crosses these many goes round in circles.
  static constexpr int max_triangles = 20000;
  static constexpr int max_corrections = 12;

  const TriangleMesh& mesh_;
  const HalfEdgeMesh& half_edges_;
};

/// Goes straight on, each triangle unfolded into the plane of the one before, for `length` or to a border.
Walker StraightestPath::walk(Walker walker, double length) const {
  int entered_by = -1;
  for (int i = 0; i < max_triangles; ++i) {
    const Triangle triangle = corners(walker.triangle);
    const std::array<Vec3, 3> corner{triangle.a, triangle.b, triangle.c};
    const Vec3 normal = mesh_.geometric_normal(walker.triangle);
    double nearest = length - walker.walked;
    int exit = -1;
    for (int k = 0; k < 3; ++k) {
      if (k == entered_by) continue;
      const Vec3 edge = corner[static_cast<std::size_t>((k + 1) % 3)] - corner[static_cast<std::size_t>(k)];
      const Vec3 inwards = glm::cross(normal, edge);
      const double speed = -glm::dot(walker.direction, inwards);
      if (!(speed > 0)) continue;
      const double s =
          std::max(glm::dot(walker.position - corner[static_cast<std::size_t>(k)], inwards), 0.0) / speed;
      if (s < nearest) nearest = s, exit = k;
    }
    walker.position += nearest * walker.direction;
    walker.walked += nearest;
    if (exit < 0) return walker;  // arrived
    const uint32_t next = half_edges_.across(walker.triangle, exit);
    if (next == no_index) return walker;
    const auto from = static_cast<std::size_t>(exit), to = (from + 1) % 3;
    const Vec3 edge = glm::normalize(corner[to] - corner[from]);
    const double along = glm::dot(walker.direction, edge);
    // The edge runs the other way in the neighbour, so that this points into it.
    const Vec3 into = glm::cross(edge, mesh_.geometric_normal(next));
    walker.direction = along * edge + std::sqrt(std::max(1 - along * along, 0.0)) * into;
    for (int k = 0; k < 3; ++k)
      if (half_edges_.vertex(next, (k + 1) % 3) == half_edges_.vertex(walker.triangle, exit) &&
          half_edges_.vertex(next, k) == half_edges_.vertex(walker.triangle, (exit + 1) % 3))
        entered_by = k;
    walker.triangle = next;
  }
  return walker;
}

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
    const Walker end = walk({from.triangle, from.position, direction, 0}, length);
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
