#include "geometry/half_edge_mesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "geometry/mesh_edges.h"

namespace alabaster {

namespace {

/// Connectivity alone: positions stay in the TriangleMesh.
struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3f;
};
using OpenMesh3 = OpenMesh::TriMesh_ArrayKernelT<Traits>;

/// Numbers the fans: corners belong to one vertex when a walk around it through edges of two agreeing
/// triangles connects them.
std::size_t number_fans(const TriangleMesh& mesh, std::vector<uint32_t>& vertex_of_corner) {
  DisjointSets sets(3 * mesh.triangle_count());
  const auto corner = [](const TriangleSide& side, bool end) {
    return 3 * side.triangle + (side.side + (end ? 1u : 0u)) % 3;
  };
  for_each_edge(sorted_sides(mesh), [&](const TriangleSide* first, const TriangleSide* last) {
    if (last - first != 2 || first[0].forward == first[1].forward) return;
    sets.unite(corner(first[0], false), corner(first[1], true));
    sets.unite(corner(first[0], true), corner(first[1], false));
  });
  return sets.number(vertex_of_corner);
}

}  // namespace

struct HalfEdgeMesh::Impl {
  OpenMesh3 mesh;
  std::vector<uint32_t> position_of;  // by vertex
  std::vector<Index3> vertices;       // by triangle
  std::vector<Index3> half_edges;     // by triangle, side k; no_index where OpenMesh refused the triangle
  std::vector<uint32_t> triangle_of;  // by OpenMesh's face

  /// Calls visit(outgoing half-edge) counter-clockwise, at a border from the first triangle's to the edge
  /// after the last triangle, which has no face.
  template <class Visit>
  void walk_around(uint32_t vertex, Visit&& visit) const {
    const auto first = mesh.halfedge_handle(OpenMesh::VertexHandle(static_cast<int>(vertex)));
    if (!first.is_valid()) return;
    const auto next = [&](OpenMesh::HalfedgeHandle h) {
      return mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h));
    };
    // OpenMesh's half-edge of a border vertex is the border's.
    const auto start = mesh.is_boundary(first) ? next(first) : first;
    auto h = start;
    do {
      visit(h);
      h = next(h);
    } while (h != start);
  }
};

HalfEdgeMesh::HalfEdgeMesh(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>()) {
  Impl& impl = *impl_;
  std::vector<uint32_t> vertex_of_corner;
  const std::size_t count = number_fans(mesh, vertex_of_corner);
  impl.mesh.reserve(count, 3 * mesh.triangle_count() / 2 + count, mesh.triangle_count());
  impl.position_of.resize(count);
  for (std::size_t v = 0; v < count; ++v) impl.mesh.new_vertex();
  impl.vertices.resize(mesh.triangle_count());
  impl.half_edges.assign(mesh.triangle_count(), {no_index, no_index, no_index});
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    std::array<OpenMesh::VertexHandle, 3> corners;
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t v = impl.vertices[t][k] = vertex_of_corner[3 * t + k];
      impl.position_of[v] = mesh.corners[t][k];
      corners[k] = OpenMesh::VertexHandle(static_cast<int>(v));
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    const auto face = impl.mesh.add_face(corners.data(), 3);
    if (!face.is_valid()) continue;
    impl.triangle_of.push_back(t);
    auto h = impl.mesh.halfedge_handle(face);
    while (impl.mesh.from_vertex_handle(h) != corners[0]) h = impl.mesh.next_halfedge_handle(h);
    for (std::size_t k = 0; k < 3; ++k, h = impl.mesh.next_halfedge_handle(h))
      impl.half_edges[t][k] = static_cast<uint32_t>(h.idx());
  }
}

HalfEdgeMesh::~HalfEdgeMesh() = default;
HalfEdgeMesh::HalfEdgeMesh(HalfEdgeMesh&&) noexcept = default;
HalfEdgeMesh& HalfEdgeMesh::operator=(HalfEdgeMesh&&) noexcept = default;

std::size_t HalfEdgeMesh::vertex_count() const {
  return impl_->position_of.size();
}

uint32_t HalfEdgeMesh::vertex(uint32_t triangle, int k) const {
  return impl_->vertices[triangle][static_cast<std::size_t>(k)];
}

uint32_t HalfEdgeMesh::position_of(uint32_t vertex) const {
  return impl_->position_of[vertex];
}

uint32_t HalfEdgeMesh::across(uint32_t triangle, int k) const {
  const uint32_t h = impl_->half_edges[triangle][static_cast<std::size_t>(k)];
  if (h == no_index) return no_index;
  const auto opposite = impl_->mesh.opposite_halfedge_handle(OpenMesh::HalfedgeHandle(static_cast<int>(h)));
  const auto face = impl_->mesh.face_handle(opposite);
  return face.is_valid() ? impl_->triangle_of[static_cast<std::size_t>(face.idx())] : no_index;
}

bool HalfEdgeMesh::is_border(uint32_t vertex) const {
  return impl_->mesh.is_boundary(OpenMesh::VertexHandle(static_cast<int>(vertex)));
}

void HalfEdgeMesh::fan(uint32_t vertex, std::vector<uint32_t>& triangles) const {
  triangles.clear();
  impl_->walk_around(vertex, [&](OpenMesh::HalfedgeHandle h) {
    const auto face = impl_->mesh.face_handle(h);
    if (face.is_valid()) triangles.push_back(impl_->triangle_of[static_cast<std::size_t>(face.idx())]);
  });
}

void HalfEdgeMesh::ring(uint32_t vertex, std::vector<uint32_t>& vertices) const {
  vertices.clear();
  impl_->walk_around(vertex, [&](OpenMesh::HalfedgeHandle h) {
    vertices.push_back(static_cast<uint32_t>(impl_->mesh.to_vertex_handle(h).idx()));
  });
}

}  // namespace alabaster
