#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace alabaster {

/// What is wrong with a mesh, counted. Nothing here stops a render; callers word the warnings.
struct MeshReport {
  std::size_t broken_triangles = 0;        // removed: a position is NaN or infinite, or an index out of range
  std::size_t degenerate_triangles = 0;    // removed: no area
  std::size_t duplicate_triangles = 0;     // removed (same three positions, either winding)
  std::size_t non_manifold_edges = 0;      // edges with more than two triangles: cut open for the half-edges
  std::size_t border_edges = 0;            // edges with one triangle
  std::size_t inconsistent_edges = 0;      // neighbours wound the other way, before mending
  std::size_t flipped_triangles = 0;       // turned to agree with their component, or outwards with it
  std::size_t non_orientable_patches = 0;  // Moebius bands and the like: some neighbours still disagree
  std::size_t components = 0;              // sets of triangles connected by edges
  bool closed = false;                     // every edge has exactly two triangles, and there is one
  std::vector<Vec3> border_example;        // the ends of one border edge, if any
};

/// Removes broken, degenerate and duplicate triangles, makes the winding of each component agree (with the
/// majority of its triangles) and point outwards where it is closed, and counts what it found. A closed
/// component that is wound inwards and lies inside another one is a cavity and stays as it is. A triangle
/// whose three different corners lie on one line counts as connecting its neighbours before it goes.
/// Deterministic, O(n log n); works on any input, never throws.
MeshReport clean_mesh(TriangleMesh& mesh);

/// Connectivity of a mesh by half-edges. Where more than two triangles meet in an edge, or neighbours are
/// wound against each other, the surface is cut open: each of its vertices has one fan of triangles around
/// it, closed or open, so that a position may belong to several vertices.
class HalfEdgeMesh {
 public:
  /// The mesh should be clean; triangles that cannot be connected are left without neighbours. The mesh is
  /// not referred to afterwards.
  explicit HalfEdgeMesh(const TriangleMesh& mesh);
  ~HalfEdgeMesh();
  HalfEdgeMesh(HalfEdgeMesh&&) noexcept;
  HalfEdgeMesh& operator=(HalfEdgeMesh&&) noexcept;

  std::size_t vertex_count() const;
  /// The vertex at corner k of a triangle, and the position (index into the mesh) of a vertex.
  uint32_t vertex(uint32_t triangle, int k) const;
  uint32_t position_of(uint32_t vertex) const;
  /// The triangle beyond the edge from corner k to corner k + 1, or no_index at a border.
  uint32_t across(uint32_t triangle, int k) const;
  bool is_border(uint32_t vertex) const;
  /// Triangles around a vertex, in the order of a walk around it.
  void fan(uint32_t vertex, std::vector<uint32_t>& triangles) const;
  /// Vertices connected to a vertex by an edge, in the order of a walk around it.
  void ring(uint32_t vertex, std::vector<uint32_t>& vertices) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// For each triangle, the neighbour beyond the edge from corner k to corner k + 1: no_index at a border or
/// where more than two triangles meet. Neighbours wound against each other count.
std::vector<Index3> triangle_neighbours(const TriangleMesh& mesh);

}  // namespace alabaster
