#pragma once

#include <string>
#include <vector>

#include "core/vec.h"
#include "geometry/mesh.h"
#include "scene/gltf_document.h"

namespace tinygltf {
struct Mesh;
class Node;
struct Primitive;
}  // namespace tinygltf

namespace alabaster {

/// One primitive's triangles in the space of its mesh, morph targets applied.
struct GltfPrimitive {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;   // empty: flat
  std::vector<Vec4> tangents;  // empty: none
  std::vector<std::vector<Vec2f>> uv_sets;
  std::vector<Vec4f> colours;  // empty: none
  /// Skinning: joints and weights, four per vertex and set; empty when there are none.
  std::vector<std::vector<uint32_t>> joints;
  std::vector<std::vector<Vec4>> weights;
  std::vector<Index3> triangles;
  bool morphed = false;
  std::size_t left_over_indices = 0;  // did not make a triangle
};

/// Whether a primitive has triangles at all; points and lines have not.
bool has_triangles(const tinygltf::Primitive& primitive);

/// Throws InputError when data are missing, of the wrong type or out of range. `morph_weights` are the
/// node's, or the mesh's where the node has none.
GltfPrimitive read_primitive(const GltfDocument& document, const tinygltf::Primitive& primitive,
                             const std::vector<double>& morph_weights, const std::string& place);

}  // namespace alabaster
