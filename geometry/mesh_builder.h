#pragma once

#include <functional>
#include <unordered_map>

#include "core/rng.h"
#include "geometry/mesh.h"

namespace alabaster {

/// Assembles a TriangleMesh from patches. Positions are welded where they are equal bit by bit, so patches
/// join when they compute their common border by the same arithmetic.
class MeshBuilder {
 public:
  struct Vertex {
    Vec3 position{0};
    Vec3 normal{0};  // need not be unit
    Vec2 uv{0};
  };
  /// A vertex of a patch at column i and row j. Integers name the grid's vertices; halves of i are asked for
  /// where a row has shrunk to a point, for the attributes of the triangle that ends there.
  using PatchFunction = std::function<Vertex(double i, double j)>;

  /// Columns run to the right and rows downwards as seen from outside. A row whose vertices coincide (the
  /// pole of a sphere) gives one triangle per column instead of two.
  void add_patch(int columns, int rows, const PatchFunction& vertex);

  /// Applies to the triangles added afterwards.
  void set_material(uint16_t material) { material_ = material; }

  TriangleMesh finish() &&;

 private:
  struct PositionHash {
    std::size_t operator()(const std::array<uint64_t, 3>& key) const {
      return hash_combine(hash_combine(key[0], key[1]), key[2]);
    }
  };
  struct GridVertex {
    uint32_t position, attribute;
  };
  uint32_t add_position(const Vec3& p);
  uint32_t add_attribute(const Vertex& vertex);
  void add_triangle(const GridVertex& a, const GridVertex& b, const GridVertex& c);
  void add_quad(const std::array<GridVertex, 4>& corners, const PatchFunction& vertex, double i, double j);

  TriangleMesh mesh_;
  std::unordered_map<std::array<uint64_t, 3>, uint32_t, PositionHash> position_index_;
  uint16_t material_ = 0;
};

/// (cos, sin) of the k-th of n equal steps around the circle, the same bits for k and k + n.
Vec2 circle_point(double k, int n);

}  // namespace alabaster
