#include "geometry/half_edge_mesh.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "core/rng.h"
#include "geometry/shapes.h"
#include "support/nasty_meshes.h"

using namespace alabaster;

namespace {

void turn(TriangleMesh& mesh, std::size_t t) {
  std::swap(mesh.corners[t][1], mesh.corners[t][2]);
  std::swap(mesh.attributes[t][1], mesh.attributes[t][2]);
}

/// Appends `other`, shifted and scaled; attributes are dropped.
void append(TriangleMesh& mesh, const TriangleMesh& other, const Vec3& shift, double scale,
            bool inward = false) {
  const auto base = static_cast<uint32_t>(mesh.positions.size());
  for (const Vec3& p : other.positions) mesh.positions.push_back(p * scale + shift);
  for (const Index3& c : other.corners)
    mesh.corners.push_back({base + c[0], base + c[inward ? 2 : 1], base + c[inward ? 1 : 2]});
  mesh.attributes = mesh.corners;
  mesh.materials.assign(mesh.corners.size(), 0);
}

}  // namespace

TEST_CASE("clean shapes stay as they are", "[clean_mesh]") {
  struct Shape {
    const char* name;
    TriangleMesh mesh;
    bool closed;
  };
  for (Shape& shape : std::vector<Shape>{{"plane", make_plane(1, 4), false},
                                         {"sphere", make_sphere(1, 24), true},
                                         {"torus", make_torus(1, 0.3, 24), true},
                                         {"cylinder", make_cylinder(1, 2, 24), true},
                                         {"blob", make_blob(1, 0.1, 24), true},
                                         {"cavity", make_cavity(1, 2, 24), true},
                                         {"slab", make_slab(1, 0.1, 4), true},
                                         {"folded sheet", make_folded_sheet(1, 0.1, 0.05, 12), true}}) {
    INFO(shape.name);
    const std::vector<Index3> before = shape.mesh.corners;
    const MeshReport report = clean_mesh(shape.mesh);
    CHECK(shape.mesh.corners == before);
    CHECK(report.closed == shape.closed);
    CHECK(report.non_manifold_edges == 0);
    CHECK(report.flipped_triangles == 0);
    CHECK(report.broken_triangles + report.degenerate_triangles + report.duplicate_triangles == 0);
    CHECK((report.border_edges == 0) == shape.closed);
    CHECK(report.border_example.size() == (shape.closed ? 0 : 2));
  }
}

TEST_CASE("random windings are mended whatever was turned", "[clean_mesh]") {
  Rng rng(7);
  for (int repeat = 0; repeat < 5; ++repeat) {
    TriangleMesh mesh = make_torus(1, 0.3, 24);
    const double volume = enclosed_volume(mesh);
    const std::vector<Index3> good = mesh.corners, attributes = mesh.attributes;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      if (rng.uniform() < 0.2 * (repeat + 1)) turn(mesh, t);
    const MeshReport report = clean_mesh(mesh);
    CHECK((report.inconsistent_edges > 0) == (repeat < 4));
    CHECK(report.flipped_triangles > 0);
    CHECK(report.closed);
    CHECK(enclosed_volume(mesh) == Approx(volume));
    CHECK(clean_mesh(mesh).flipped_triangles == 0);
    // A corner keeps its attribute when its triangle is turned.
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto was = std::find(good[t].begin(), good[t].end(), mesh.corners[t][k]) - good[t].begin();
        CHECK(mesh.attributes[t][k] == attributes[t][static_cast<std::size_t>(was)]);
      }
  }
}

TEST_CASE("a shell wound inwards is turned, unless it is a cavity in another", "[clean_mesh]") {
  const TriangleMesh ball = make_sphere(1, 16);
  const double volume = enclosed_volume(ball);
  TriangleMesh mesh;
  append(mesh, ball, {0, 0, 0}, 1, true);        // inside out: mended
  append(mesh, ball, {0.1, 0, 0}, 0.5, true);    // a cavity: stays
  append(mesh, ball, {0.1, 0, 0}, 0.25, false);  // a stone in the cavity: stays
  append(mesh, ball, {5, 0, 0}, 1, false);       // a neighbour
  append(mesh, ball, {-5, 0, 0}, 1, true);       // mended
  const MeshReport report = clean_mesh(mesh);
  CHECK(report.components == 5);
  CHECK(report.closed);
  CHECK(report.flipped_triangles == 2 * ball.triangle_count());
  CHECK(enclosed_volume(mesh) == Approx(volume * (3 - 0.125 + 0.015625)));
}

TEST_CASE("broken, degenerate and duplicate triangles are counted and removed", "[clean_mesh]") {
  TriangleMesh mesh = nasty::tetrahedron();
  mesh.positions.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  mesh.positions.push_back({0, std::numeric_limits<double>::infinity(), 0});
  mesh.corners.insert(mesh.corners.end(),
                      {{0, 1, 4}, {5, 1, 2}, {0, 1, 77}, {0, 0, 1}, {2, 2, 2}, {1, 2, 0}, {2, 1, 0}});
  mesh.attributes.resize(mesh.corners.size(), {0, 0, 0});
  mesh.materials = {1, 2, 3, 4, 9, 9, 9, 9, 9, 9, 9};
  const MeshReport report = clean_mesh(mesh);
  CHECK(report.broken_triangles == 3);
  CHECK(report.degenerate_triangles == 2);
  CHECK(report.duplicate_triangles == 2);
  CHECK(report.closed);
  CHECK(report.components == 1);
  CHECK(mesh.triangle_count() == 4);
  CHECK(mesh.materials == std::vector<uint16_t>{1, 2, 3, 4});
  CHECK(mesh.attributes.size() == 4);
}

TEST_CASE("a flat triangle between two others keeps the surface closed", "[clean_mesh]") {
  // A tetrahedron whose edge 0-1 has a corner 4 in its middle on one side only.
  TriangleMesh mesh = nasty::from({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0, 0}},
                                  {{0, 2, 4}, {4, 2, 1}, {0, 4, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  const MeshReport report = clean_mesh(mesh);
  CHECK(report.degenerate_triangles == 1);
  CHECK(report.closed);
  CHECK(report.flipped_triangles == 0);
  CHECK(mesh.triangle_count() == 5);
}

TEST_CASE("nasty meshes are named", "[clean_mesh]") {
  TriangleMesh empty;
  const MeshReport none = clean_mesh(empty);
  CHECK((none.components == 0 && !none.closed));

  TriangleMesh single = nasty::single_triangle();
  const MeshReport one = clean_mesh(single);
  CHECK((one.components == 1 && one.border_edges == 3 && !one.closed));
  REQUIRE(one.border_example.size() == 2);

  TriangleMesh band = nasty::moebius();
  const MeshReport moebius = clean_mesh(band);
  CHECK(moebius.non_orientable_patches == 1);
  CHECK(moebius.components == 1);
  CHECK(moebius.border_edges == 24);
  CHECK(band.triangle_count() == 24);

  TriangleMesh leaves = nasty::book();
  const MeshReport book = clean_mesh(leaves);
  CHECK(book.non_manifold_edges == 1);
  CHECK(book.border_edges == 6);
  CHECK(book.components == 1);

  TriangleMesh pair = nasty::two_at_an_edge();
  std::swap(pair.corners[5][0], pair.corners[5][1]);
  const MeshReport two = clean_mesh(pair);
  CHECK(two.non_manifold_edges == 1);
  CHECK_FALSE(two.closed);
  CHECK(two.components == 1);
  CHECK(two.flipped_triangles == 1);
  CHECK(enclosed_volume(pair) == Approx(2.0 / 6));

  TriangleMesh tie = nasty::bow_tie();
  CHECK(clean_mesh(tie).components == 2);
}

TEST_CASE("half-edges of a closed mesh: every side has its twin, Euler's formula holds", "[half_edge]") {
  for (const auto& [mesh, euler] : {std::pair{make_sphere(1, 16), 2}, std::pair{make_torus(1, 0.3, 16), 0}}) {
    const HalfEdgeMesh half_edges(mesh);
    const auto v = static_cast<long>(half_edges.vertex_count()), f = static_cast<long>(mesh.triangle_count());
    CHECK(v - 3 * f / 2 + f == euler);
    std::vector<uint32_t> fan, ring;
    std::size_t corners = 0;
    for (uint32_t vertex = 0; vertex < half_edges.vertex_count(); ++vertex) {
      CHECK_FALSE(half_edges.is_border(vertex));
      half_edges.fan(vertex, fan);
      half_edges.ring(vertex, ring);
      CHECK(fan.size() == ring.size());
      corners += fan.size();
    }
    CHECK(corners == 3 * mesh.triangle_count());
    const std::vector<Index3> neighbours = triangle_neighbours(mesh);
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
      for (int k = 0; k < 3; ++k) {
        const uint32_t other = half_edges.across(t, k);
        REQUIRE(other != no_index);
        CHECK(other == neighbours[t][static_cast<std::size_t>(k)]);
        CHECK(half_edges.position_of(half_edges.vertex(t, k)) ==
              mesh.corners[t][static_cast<std::size_t>(k)]);
      }
  }
}

TEST_CASE("half-edges cut open what is not manifold", "[half_edge]") {
  const HalfEdgeMesh tie(nasty::bow_tie());
  CHECK(tie.vertex_count() == 6);  // the waist twice
  const HalfEdgeMesh book(nasty::book());
  CHECK(book.vertex_count() == 9);
  for (uint32_t t = 0; t < 3; ++t)
    for (int k = 0; k < 3; ++k) CHECK(book.across(t, k) == no_index);
  TriangleMesh band = nasty::moebius();
  clean_mesh(band);
  const HalfEdgeMesh moebius(band);
  std::size_t borders = 0;
  for (uint32_t t = 0; t < band.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) borders += moebius.across(t, k) == no_index;
  CHECK(borders == 24 + 2);  // cut across once: two more sides than the band's own border
  TriangleMesh wild;         // every triangle of five points, both ways: nothing but trouble
  for (int i = 0; i < 5; ++i) wild.positions.push_back({i, i * i, i * i * i});
  for (uint32_t a = 0; a < 5; ++a)
    for (uint32_t b = 0; b < 5; ++b)
      for (uint32_t c = 0; c < 5; ++c) wild.corners.push_back({a, b, c});
  const HalfEdgeMesh half_edges(wild);
  std::vector<uint32_t> fan;
  for (uint32_t v = 0; v < half_edges.vertex_count(); ++v) half_edges.fan(v, fan);
  CHECK(half_edges.vertex_count() > 0);
}

TEST_CASE("the fan of a border vertex is walked in order", "[half_edge]") {
  const HalfEdgeMesh half_edges(make_plane(1, 4));
  std::vector<uint32_t> fan, ring;
  std::size_t borders = 0;
  for (uint32_t v = 0; v < half_edges.vertex_count(); ++v) {
    half_edges.fan(v, fan);
    half_edges.ring(v, ring);
    CHECK(ring.size() == fan.size() + (half_edges.is_border(v) ? 1 : 0));
    borders += half_edges.is_border(v);
    for (std::size_t i = 0; i < fan.size(); ++i)
      for (const uint32_t end : {ring[i], ring[(i + 1) % ring.size()]}) {
        const std::array<uint32_t, 3> corners{half_edges.vertex(fan[i], 0), half_edges.vertex(fan[i], 1),
                                              half_edges.vertex(fan[i], 2)};
        CHECK(std::count(corners.begin(), corners.end(), end) == 1);
      }
  }
  CHECK(borders == 16);
}
