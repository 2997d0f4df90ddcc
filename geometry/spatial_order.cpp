#include "geometry/spatial_order.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"

namespace alabaster {

namespace {

// The lowest 21 bits, each followed by two zeros.
uint64_t spread_bits(uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffffULL;
  v = (v | v << 16) & 0x001f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}

// Places along a Morton curve, each with its triangle. Equal ones keep their order.
std::vector<std::pair<uint64_t, uint32_t>> along_curve(const TriangleMesh& mesh) {
  const BoundingBox box = bounding_box(mesh);
  const Vec3 size = box.high - box.low;
  const double extent = std::max({size.x, size.y, size.z}), scale = extent > 0 ? 0x1fffff / extent : 0;
  std::vector<std::pair<uint64_t, uint32_t>> places(mesh.triangle_count());
  parallel_for(places.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto triangle = static_cast<uint32_t>(t);
      const Vec3 q = (mesh.position(triangle, Vec2(1.0 / 3)) - box.low) * scale;
      const auto bits = [](double v) {
        return spread_bits(static_cast<uint64_t>(std::clamp(v, 0.0, double{0x1fffff})));
      };
      places[t] = {bits(q.x) | bits(q.y) << 1 | bits(q.z) << 2, triangle};
    }
  });
  std::sort(places.begin(), places.end());
  return places;
}

template <class T>
void permute_triangles(std::vector<T>& values, const std::vector<std::pair<uint64_t, uint32_t>>& order) {
  if (values.empty()) return;
  std::vector<T> sorted;
  sorted.reserve(order.size());
  for (const auto& [place, triangle] : order) sorted.push_back(values[triangle]);
  values = std::move(sorted);
}

// New numbers in the order of first use; returns the old number of each new one.
std::vector<uint32_t> renumber(std::vector<Index3>& indices, std::size_t count) {
  std::vector<uint32_t> fresh(count, no_index), old;
  old.reserve(count);
  for (Index3& index : indices)
    for (uint32_t& i : index) {
      if (fresh[i] == no_index) {
        fresh[i] = static_cast<uint32_t>(old.size());
        old.push_back(i);
      }
      i = fresh[i];
    }
  return old;
}

template <class T>
void gather(std::vector<T>& values, const std::vector<uint32_t>& old) {
  if (values.empty()) return;
  std::vector<T> sorted;
  sorted.reserve(old.size());
  for (const uint32_t i : old) sorted.push_back(values[i]);
  values = std::move(sorted);
}

}  // namespace

void sort_in_space(TriangleMesh& mesh) {
  const auto order = along_curve(mesh);
  permute_triangles(mesh.corners, order);
  permute_triangles(mesh.attributes, order);
  permute_triangles(mesh.materials, order);
  const bool shared = mesh.attributes.empty();  // then corners index the attribute arrays as well
  const std::vector<uint32_t> positions = renumber(mesh.corners, mesh.positions.size());
  gather(mesh.positions, positions);
  std::size_t attributes = std::max({mesh.normals.size(), mesh.tangents.size(), mesh.colours.size()});
  for (const auto& set : mesh.uv_sets) attributes = std::max(attributes, set.size());
  for (const Index3& index : mesh.attributes)
    for (const uint32_t i : index) attributes = std::max(attributes, std::size_t{i} + 1);
  const std::vector<uint32_t> old = shared ? positions : renumber(mesh.attributes, attributes);
  gather(mesh.normals, old);
  for (auto& set : mesh.uv_sets) gather(set, old);
  gather(mesh.tangents, old);
  gather(mesh.colours, old);
}

}  // namespace alabaster
