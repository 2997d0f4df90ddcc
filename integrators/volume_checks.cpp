#include "integrators/volume_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

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

/// Where an edge of `mesh` meets the surface of another object.
std::optional<Vec3> crossing(const Scene& scene, const TriangleMesh& mesh, uint32_t other) {
  std::vector<Hit> hits;
  const BoundingBox& box = scene.objects[other].bounds;
  for (const Index3& corner : mesh.corners)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &from = mesh.positions[corner[k]], &to = mesh.positions[corner[(k + 1) % 3]];
      BoundingBox edge;
      edge.extend(from), edge.extend(to);
      if (!boxes_meet(edge, box)) continue;
      scene.rays.all_hits(other, Ray{from, to - from, 0, 1}, hits);
      if (!hits.empty()) return from + hits.front().t * (to - from);
    }
  return std::nullopt;
}

bool lies_within(const Scene& scene, const Vec3& p, uint32_t object) {
  std::vector<Hit> hits;
  scene.rays.all_hits(object, Ray{p, Vec3(0.6, 0.64, 0.48)}, hits);
  return hits.size() % 2 == 1;
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
  for (uint32_t a = 0; a < scene.objects.size(); ++a)
    for (uint32_t b = 0; b < scene.objects.size(); ++b) {
      if (a == b || !boxes_meet(scene.objects[a].bounds, scene.objects[b].bounds)) continue;
      if (!has_medium(scene, scene.objects[a]) || !has_medium(scene, scene.objects[b])) continue;
      if (const auto p = crossing(scene, scene.objects[a].mesh, b)) refuse(a, b, "overlaps", *p);
      const Vec3& first = scene.objects[a].mesh.positions.front();
      if (scene.objects[b].report.closed && lies_within(scene, first, b)) refuse(a, b, "lies in", first);
    }
}

}  // namespace alabaster
