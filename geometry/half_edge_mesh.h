#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace alabaster {

/// What is wrong with a mesh, counted. Nothing here stops a render; callers word the warnings.
struct MeshReport {
  std::size_t degenerate_triangles = 0;  // removed
  std::size_t duplicate_triangles = 0;   // removed (same three positions, either winding)
  std::size_t non_manifold_edges = 0;    // edges with more than two triangles: cut open for the half-edges
  std::size_t border_edges = 0;          // edges with one triangle
  std::size_t inconsistent_edges = 0;    // neighbours wound the other way, before mending
  std::size_t flipped_triangles = 0;     // turned to agree with their component
  std::size_t components = 0;
  bool closed = false;               // every edge has exactly two triangles
  std::vector<Vec3> border_example;  // the ends of one border edge, if any
};

/// Removes degenerate and duplicate triangles, makes the winding of each component agree and point outwards
/// where it is closed (positive volume), and counts what it found. Works on any input; never throws.
MeshReport clean_mesh(TriangleMesh& mesh);

}  // namespace alabaster
