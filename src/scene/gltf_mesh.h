#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "core/rng.h"
#include "geometry/mesh.h"
#include "scene/gltf_primitive.h"

namespace alabaster {

/// Welds the primitives of one node into one mesh in world space: positions that are equal bit by bit become
/// one, whatever their attributes. Vertices that no triangle uses are left out, triangles with a position
/// that is not finite are dropped and counted.
class GltfMeshBuilder {
 public:
  struct Counts {
    std::size_t non_finite_triangles = 0, bad_normals = 0, non_finite_uvs = 0, flat_primitives = 0;
  };

  /// `vertex_transforms` has one matrix for all vertices, or one per vertex (skinning). A mirroring matrix
  /// turns the triangles over, as glTF asks. UV set `primary_uv_set` is swapped with set 0.
  void add(const GltfPrimitive& primitive, const std::vector<Mat4>& vertex_transforms, uint16_t material,
           std::size_t primary_uv_set);

  /// `tangent_uv_set`: some material has a normal map in this set, so tangents are kept, or made where a
  /// primitive came without; no_index for none.
  TriangleMesh finish(std::size_t tangent_uv_set) &&;
  const Counts& counts() const { return counts_; }

 private:
  struct PositionHash {
    std::size_t operator()(const std::array<uint64_t, 3>& key) const {
      return hash_combine(hash_combine(key[0], key[1]), key[2]);
    }
  };
  struct Source;  // one primitive with its transforms

  uint32_t weld(const Vec3& p);
  uint32_t add_attribute(const Source& source, uint32_t vertex, const Vec3& normal);
  void add_triangle(Source& source, Index3 triangle, uint16_t material);
  void grow_optional_arrays(const GltfPrimitive& primitive, std::size_t primary_uv_set);

  TriangleMesh mesh_;
  std::unordered_map<std::array<uint64_t, 3>, uint32_t, PositionHash> position_index_;
  bool all_have_tangents_ = true, has_colours_ = false;
  Counts counts_;
};

}  // namespace alabaster
