#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "geometry/half_edge_mesh.h"
#include "geometry/mesh_edges.h"
#include "geometry/ray_scene.h"
#include "geometry/triangle.h"

namespace alabaster {

namespace {

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Triangle triangle_of(const TriangleMesh& mesh, std::size_t t) {
  const Index3& c = mesh.corners[t];
  return {mesh.positions[c[0]], mesh.positions[c[1]], mesh.positions[c[2]]};
}

bool is_broken(const TriangleMesh& mesh, std::size_t t) {
  const Index3& c = mesh.corners[t];
  return std::any_of(c.begin(), c.end(),
                     [&](uint32_t i) { return i >= mesh.positions.size() || !is_finite(mesh.positions[i]); });
}

/// No area to speak of: the height is below the rounding of the coordinates that made it.
bool is_flat(const TriangleMesh& mesh, std::size_t t) {
  const Triangle triangle = triangle_of(mesh, t);
  return !(glm::length(triangle.area_vector()) > 1e-14 * triangle.longest_edge_squared());
}

/// Keeps the triangles for which `keep` holds, in their order.
template <class Keep>
std::size_t retain_triangles(TriangleMesh& mesh, Keep&& keep) {
  std::size_t kept = 0;
  const std::size_t count = mesh.triangle_count();
  const bool attributes = mesh.attributes.size() == count, materials = mesh.materials.size() == count;
  for (std::size_t t = 0; t < count; ++t) {
    if (!keep(t)) continue;
    mesh.corners[kept] = mesh.corners[t];
    if (attributes) mesh.attributes[kept] = mesh.attributes[t];
    if (materials) mesh.materials[kept] = mesh.materials[t];
    ++kept;
  }
  mesh.corners.resize(kept);
  if (attributes) mesh.attributes.resize(kept);
  if (materials) mesh.materials.resize(kept);
  return count - kept;
}

std::size_t remove_duplicates(TriangleMesh& mesh) {
  const auto key = [&](uint32_t t) {
    Index3 sorted = mesh.corners[t];
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  std::vector<std::pair<Index3, uint32_t>> keys(mesh.triangle_count());
  for (uint32_t t = 0; t < keys.size(); ++t) keys[t] = {key(t), t};
  std::sort(keys.begin(), keys.end());
  std::vector<bool> duplicate(keys.size(), false);
  for (std::size_t i = 1; i < keys.size(); ++i)
    duplicate[keys[i].second] = keys[i].first == keys[i - 1].first;
  return retain_triangles(mesh, [&](std::size_t t) { return !duplicate[t]; });
}

void turn(TriangleMesh& mesh, std::size_t t) {
  std::swap(mesh.corners[t][1], mesh.corners[t][2]);
  if (mesh.attributes.size() == mesh.triangle_count())
    std::swap(mesh.attributes[t][1], mesh.attributes[t][2]);
}

/// Patches: triangles connected through edges that have exactly two of them.
class Winding {
 public:
  Winding(TriangleMesh& mesh, const std::vector<TriangleSide>& sides)
      : mesh_(mesh), sides_(sides), turned_(mesh.triangle_count(), false) {
    connect();
    agree();
    find_closed();
  }

  /// Turns the triangles; returns how many.
  std::size_t apply() {
    orient_outwards();
    std::size_t count = 0;
    for (std::size_t t = 0; t < turned_.size(); ++t)
      if (turned_[t]) turn(mesh_, t), ++count;
    return count;
  }

  std::size_t non_orientable = 0;

 private:
  struct Neighbour {
    uint32_t triangle = no_index;
    bool opposed = false;  // wound the other way
  };

  void connect();
  void agree();
  void find_closed();
  void orient_outwards();
  bool is_inside_another(uint32_t patch, const Vec3& point, const RayScene& scene) const;

  TriangleMesh& mesh_;
  const std::vector<TriangleSide>& sides_;
  std::vector<std::array<Neighbour, 3>> neighbours_;
  std::vector<bool> turned_;
  std::vector<uint32_t> patch_of_;
  std::vector<bool> closed_;  // per patch: its boundary vanishes, so it encloses a volume
};

void Winding::connect() {
  neighbours_.resize(mesh_.triangle_count());
  for_each_edge(sides_, [&](const TriangleSide* first, const TriangleSide* last) {
    if (last - first != 2) return;
    const TriangleSide &a = first[0], &b = first[1];
    neighbours_[a.triangle][a.side] = {b.triangle, a.forward == b.forward};
    neighbours_[b.triangle][b.side] = {a.triangle, a.forward == b.forward};
  });
}

/// Walks each patch from its lowest triangle, turning neighbours to agree; then the minority's way is undone.
void Winding::agree() {
  patch_of_.assign(mesh_.triangle_count(), no_index);
  std::vector<uint32_t> patch;
  uint32_t patches = 0;
  for (uint32_t seed = 0; seed < mesh_.triangle_count(); ++seed) {
    if (patch_of_[seed] != no_index) continue;
    patch.assign(1, seed);
    patch_of_[seed] = patches;
    bool orientable = true;
    std::size_t turned = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const uint32_t t = patch[i];
      turned += turned_[t];
      for (const Neighbour& n : neighbours_[t]) {
        if (n.triangle == no_index) continue;
        const bool wanted = turned_[t] != n.opposed;
        if (patch_of_[n.triangle] == no_index) {
          patch_of_[n.triangle] = patches;
          turned_[n.triangle] = wanted;
          patch.push_back(n.triangle);
        } else {
          orientable = orientable && turned_[n.triangle] == wanted;
        }
      }
    }
    if (2 * turned > patch.size())
      for (const uint32_t t : patch) turned_[t] = !turned_[t];
    non_orientable += !orientable;
    ++patches;
  }
  closed_.assign(patches, true);
}

void Winding::find_closed() {
  for_each_edge(sides_, [&](const TriangleSide* first, const TriangleSide* last) {
    for (const TriangleSide* side = first; side != last; ++side) {
      const uint32_t patch = patch_of_[side->triangle];
      int sum = 0;
      for (const TriangleSide* other = first; other != last; ++other)
        if (patch_of_[other->triangle] == patch) sum += other->forward != turned_[other->triangle] ? 1 : -1;
      if (sum != 0) closed_[patch] = false;
    }
  });
}

/// Whether some other closed patch winds around the point: signed crossings of a ray, patch by patch.
bool Winding::is_inside_another(uint32_t patch, const Vec3& point, const RayScene& scene) const {
  Ray ray;
  ray.origin = point;
  ray.direction = Vec3(0.5377, 0.7071, 0.4590);  // along no likely grid
  std::vector<Hit> hits;
  scene.all_hits(0, ray, hits);
  std::vector<std::pair<uint32_t, int>> windings;
  for (const Hit& hit : hits) {
    const uint32_t other = patch_of_[hit.triangle];
    if (other == patch || !closed_[other]) continue;
    const bool leaves = glm::dot(triangle_of(mesh_, hit.triangle).area_vector(), ray.direction) > 0;
    const int sign = leaves != turned_[hit.triangle] ? 1 : -1;
    const auto found =
        std::find_if(windings.begin(), windings.end(), [&](auto& w) { return w.first == other; });
    if (found == windings.end())
      windings.emplace_back(other, sign);
    else
      found->second += sign;
  }
  return std::any_of(windings.begin(), windings.end(), [](const auto& w) { return w.second != 0; });
}

void Winding::orient_outwards() {
  const std::size_t patches = closed_.size();
  std::vector<double> volume(patches, 0.0);
  std::vector<uint32_t> first(patches, no_index);
  for (uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    const uint32_t patch = patch_of_[t];
    if (first[patch] == no_index) first[patch] = t;
    const Triangle triangle = triangle_of(mesh_, t);
    // Over a point of the patch: over the far-away origin the tetrahedra would cancel badly.
    const Vec3 apex = mesh_.positions[mesh_.corners[first[patch]][0]];
    volume[patch] += glm::dot(triangle.a - apex, triangle.area_vector()) * (turned_[t] ? -1 : 1);
  }
  std::vector<bool> inward(patches);
  for (uint32_t p = 0; p < patches; ++p) inward[p] = closed_[p] && volume[p] < 0;
  if (patches > 1 && std::find(inward.begin(), inward.end(), true) != inward.end()) {
    RayScene scene;
    scene.add(mesh_);
    scene.commit();
    for (uint32_t p = 0; p < patches; ++p)
      if (inward[p])
        inward[p] = !is_inside_another(p, triangle_of(mesh_, first[p]).point(Vec2(1.0 / 3)), scene);
  }
  for (std::size_t t = 0; t < turned_.size(); ++t)
    if (inward[patch_of_[t]]) turned_[t] = !turned_[t];
}

void count_edges(const TriangleMesh& mesh, const std::vector<TriangleSide>& sides, MeshReport& report) {
  DisjointSets sets(mesh.triangle_count());
  for_each_edge(sides, [&](const TriangleSide* first, const TriangleSide* last) {
    for (const TriangleSide* side = first + 1; side < last; ++side)
      sets.unite(first->triangle, side->triangle);
    if (last - first == 1 && report.border_edges++ == 0)
      report.border_example = {mesh.positions[first->low], mesh.positions[first->high]};
    if (last - first == 2 && first[0].forward == first[1].forward) ++report.inconsistent_edges;
    if (last - first > 2) ++report.non_manifold_edges;
  });
  std::vector<uint32_t> component;
  report.components = sets.number(component);
  report.closed = !sides.empty() && report.border_edges == 0 && report.non_manifold_edges == 0;
}

bool has_two_equal_corners(const Index3& c) {
  return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

}  // namespace

MeshReport clean_mesh(TriangleMesh& mesh) {
  MeshReport report;
  report.broken_triangles = retain_triangles(mesh, [&](std::size_t t) { return !is_broken(mesh, t); });
  report.degenerate_triangles =
      retain_triangles(mesh, [&](std::size_t t) { return !has_two_equal_corners(mesh.corners[t]); });
  report.duplicate_triangles = remove_duplicates(mesh);
  const std::vector<TriangleSide> sides = sorted_sides(mesh);
  count_edges(mesh, sides, report);
  Winding winding(mesh, sides);
  report.flipped_triangles = winding.apply();
  report.non_orientable_patches = winding.non_orientable;
  report.degenerate_triangles += retain_triangles(mesh, [&](std::size_t t) { return !is_flat(mesh, t); });
  return report;
}

std::vector<Index3> triangle_neighbours(const TriangleMesh& mesh) {
  std::vector<Index3> neighbours(mesh.triangle_count(), Index3{no_index, no_index, no_index});
  for_each_edge(sorted_sides(mesh), [&](const TriangleSide* first, const TriangleSide* last) {
    if (last - first != 2) return;
    neighbours[first[0].triangle][first[0].side] = first[1].triangle;
    neighbours[first[1].triangle][first[1].side] = first[0].triangle;
  });
  return neighbours;
}

}  // namespace alabaster
