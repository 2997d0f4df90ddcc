#include "integrators/volume_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/error.h"

namespace alabaster {

void check_closed(const Scene& scene, const SceneObject& object) {
  if (object.report.closed) return;
  std::string where;
  if (object.report.border_example.size() == 2) {
    const Vec3 &a = object.report.border_example[0], &b = object.report.border_example[1];
    where = fmt::format(", one from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", a.x, a.y, a.z, b.x,
                        b.y, b.z);
  }
  throw InputError(
      scene.name, "object '" + object.name + "'",
      fmt::format(
          "walks through the volume need a closed mesh and this has {} border edges{}; close it, take "
          "it as the front of a half-space with --open sheet, or use --integrator surface",
          object.report.border_edges, where));
}

void check_one_medium(const Scene& scene, const SceneObject& object, const std::vector<uint8_t>& boundary) {
  for (const uint16_t material : object.mesh.materials)
    if (boundary[material] == 0)
      throw InputError(
          scene.name, "object '" + object.name + "'",
          "its material '" + scene.materials[material].name +
              "' does not bound the same medium as the rest; split the object or use --integrator surface");
}

namespace {

bool has_medium(const Scene& scene, const SceneObject& object) {
  return std::any_of(object.mesh.materials.begin(), object.mesh.materials.end(),
                     [&](uint16_t m) { return scene.materials[m].medium.has_value(); });
}

bool boxes_meet(const BoundingBox& a, const BoundingBox& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

// Surfaces closer than this share of the coordinates' size touch: rays are traced in single precision.
constexpr double touching = 2e-6;

double touching_distance(const BoundingBox& a, const BoundingBox& b) {
  double size = 0;
  for (const Vec3& corner : {a.low, a.high, b.low, b.high})
    size = std::max({size, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
  return touching * size;
}

BoundingBox grown(BoundingBox box, double by) {
  box.low -= by, box.high += by;
  return box;
}

/// A vertex of `mesh` on the surface of another object.
std::optional<Vec3> vertex_on(const Scene& scene, const TriangleMesh& mesh, uint32_t other, double distance) {
  const BoundingBox box = grown(scene.objects[other].bounds, distance);
  for (const Vec3& p : mesh.positions) {
    BoundingBox point;
    point.extend(p);
    if (boxes_meet(point, box) && scene.rays.closest_point(other, p, distance)) return p;
  }
  return std::nullopt;
}

/// Where an edge of `mesh` meets the surface of another object. Triangles are moved outwards by `distance`
/// first, so that a face that lies in a face of the other passes through what stands around that.
std::optional<Vec3> crossing(const Scene& scene, const TriangleMesh& mesh, uint32_t other, double distance) {
  std::vector<Hit> hits;
  const BoundingBox box = grown(scene.objects[other].bounds, distance);
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Index3& corner = mesh.corners[t];
    BoundingBox triangle;
    for (const uint32_t c : corner) triangle.extend(mesh.positions[c]);
    if (!boxes_meet(triangle, box)) continue;
    const Vec3 moved = distance * mesh.geometric_normal(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 from = mesh.positions[corner[k]] + moved, to = mesh.positions[corner[(k + 1) % 3]] + moved;
      scene.rays.all_hits(other, Ray{from, to - from, 0, 1}, hits);
      if (!hits.empty()) return from + hits.front().t * (to - from);
    }
  }
  return std::nullopt;
}

/// By three rays, of which one may graze an edge.
bool lies_within(const Scene& scene, const Vec3& p, uint32_t object) {
  std::vector<Hit> hits;
  int inside = 0;
  for (const Vec3& direction : {Vec3(0.6, 0.64, 0.48), Vec3(-0.28, 0.36, 0.89), Vec3(0.31, -0.87, -0.39)}) {
    scene.rays.all_hits(object, Ray{p, direction}, hits);
    inside += static_cast<int>(hits.size() % 2);
  }
  return inside >= 2;
}

/// One vertex of each part of a mesh that hangs together.
std::vector<Vec3> vertex_of_each_part(const TriangleMesh& mesh) {
  std::vector<uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Index3& corner : mesh.corners) {
    parent[root(corner[1])] = root(corner[0]);
    parent[root(corner[2])] = root(corner[0]);
  }
  std::vector<Vec3> result;
  std::vector<bool> seen(mesh.positions.size());
  for (const Index3& corner : mesh.corners)
    if (const uint32_t part = root(corner[0]); !seen[part]) {
      seen[part] = true;
      result.push_back(mesh.positions[part]);
    }
  return result;
}

}  // namespace

void check_media_apart(const Scene& scene) {
  const auto refuse = [&](uint32_t a, uint32_t b, const std::string& how, const Vec3& p) {
    throw InputError(
        scene.name, "object '" + scene.objects[a].name + "'",
        fmt::format("{} the medium of object '{}' at ({:.4g}, {:.4g}, {:.4g}); walks through the "
                    "volume need media apart: move or join them, or use --integrator surface",
                    how, scene.objects[b].name, p.x, p.y, p.z));
  };
  for (uint32_t first = 0; first < scene.objects.size(); ++first)
    for (uint32_t second = 0; second < first; ++second) {
      const SceneObject &one = scene.objects[second], &other = scene.objects[first];
      const double distance = touching_distance(one.bounds, other.bounds);
      if (!boxes_meet(grown(one.bounds, distance), other.bounds)) continue;
      if (!has_medium(scene, one) || !has_medium(scene, other)) continue;
      const std::pair<uint32_t, uint32_t> both_ways[] = {{second, first}, {first, second}};
      for (const auto& [a, b] : both_ways)
        if (const auto p = vertex_on(scene, scene.objects[a].mesh, b, distance)) refuse(a, b, "touches", *p);
      for (const auto& [a, b] : both_ways)
        if (const auto p = crossing(scene, scene.objects[a].mesh, b, distance)) refuse(a, b, "overlaps", *p);
      for (const auto& [a, b] : both_ways)
        if (scene.objects[b].report.closed)
          for (const Vec3& p : vertex_of_each_part(scene.objects[a].mesh))
            if (lies_within(scene, p, b)) refuse(a, b, "lies in", p);
    }
}

}  // namespace alabaster
