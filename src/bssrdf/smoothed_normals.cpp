#include "bssrdf/smoothed_normals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "core/parallel.h"
#include "core/rng.h"

namespace alabaster {
namespace {

struct Cell {
  Vec3 normal{0};  // area-weighted sum
  double area = 0;
};

/// Cells of a grid in space that hold surface; those without are not stored.
class NormalGrid {
 public:
  NormalGrid(const TriangleMesh& mesh, double cell_size) : cell_size_(cell_size) {
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      const Vec3 place = mesh.position(t, Vec2(1.0 / 3)) / cell_size_;
      const double area = mesh.area(t);
      if (!(area > 0)) continue;
      Cell& cell = cells_[key(std::floor(place.x), std::floor(place.y), std::floor(place.z))];
      cell.normal += area * mesh.geometric_normal(t);
      cell.area += area;
    }
  }

  /// Interpolated linearly between cell centres.
  Cell around(const Vec3& point) const {
    const Vec3 place = point / cell_size_ - 0.5, corner = glm::floor(place), fraction = place - corner;
    Cell sum;
    for (int k = 0; k < 8; ++k) {
      const int x = k & 1, y = k >> 1 & 1, z = k >> 2;
      const auto found = cells_.find(key(corner.x + x, corner.y + y, corner.z + z));
      if (found == cells_.end()) continue;
      const double weight = (x ? fraction.x : 1 - fraction.x) * (y ? fraction.y : 1 - fraction.y) *
                            (z ? fraction.z : 1 - fraction.z);
      sum.normal += weight * found->second.normal;
      sum.area += weight * found->second.area;
    }
    return sum;
  }

 private:
  // Two cells that share a key by chance only blur each other.
  static uint64_t key(double x, double y, double z) {
    const auto integer = [](double v) { return static_cast<uint64_t>(static_cast<int64_t>(v)); };
    return hash_combine(hash_combine(integer(x), integer(y)), integer(z));
  }
  double cell_size_;
  std::unordered_map<uint64_t, Cell> cells_;
};

}  // namespace

std::vector<Vec3f> smoothed_normals(const TriangleMesh& mesh, double scale) {
  // Cells far smaller than the object are as good as none, and their indices stay integers.
  const NormalGrid grid(mesh, std::max(scale, 1e-6 * bounding_box(mesh).diagonal()));
  std::vector<Vec3f> normals(mesh.triangle_count());
  parallel_for(normals.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto t = static_cast<uint32_t>(i);
      const Vec3 own = mesh.geometric_normal(t);
      const Cell cell = grid.around(mesh.position(t, Vec2(1.0 / 3)));
      const double length = glm::length(cell.normal);
      const bool agreed = length > 0.3 * cell.area && glm::dot(cell.normal, own) > 0;
      normals[i] = Vec3f(agreed ? cell.normal / length : own);
    }
  });
  return normals;
}

}  // namespace alabaster
