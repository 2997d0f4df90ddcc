// The distances of geometry/geodesic.h against exact polyhedral ones by CGAL (Xin and Wang 2009). CGAL is
// GPL: it is linked into this test program and nowhere else.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "core/rng.h"
#include "geometry/geodesic.h"
#include "geometry/shapes.h"
#include "support/nasty_meshes.h"

using namespace alabaster;

namespace {

/// Exact shortest distances over a mesh, and ours beside it.
class Oracle {
 public:
  explicit Oracle(TriangleMesh given) : mesh(std::move(given)), half_edges(mesh) {
    rays.add(mesh);
    rays.commit();
    std::vector<Exact::Vertex_index> vertices;
    for (const Vec3& p : mesh.positions)
      vertices.push_back(exact_.add_vertex(Kernel::Point_3(p.x, p.y, p.z)));
    for (const Index3& c : mesh.corners) {
      faces_.push_back(exact_.add_face(vertices[c[0]], vertices[c[1]], vertices[c[2]]));
      REQUIRE(faces_.back() != Exact::null_face());
    }
  }

  /// Nothing where there is no way.
  std::vector<std::optional<double>> distances(const SurfacePoint& from,
                                               const std::vector<SurfacePoint>& to) {
    Paths paths(exact_);
    paths.add_source_point(faces_[from.triangle], weights(from));
    std::vector<std::optional<double>> result;
    for (const SurfacePoint& p : to) {
      const double d = paths.shortest_distance_to_source_points(faces_[p.triangle], weights(p)).first;
      result.push_back(d >= 0 ? std::optional(d) : std::nullopt);
    }
    return result;
  }
  SurfacePoint random_point(Rng& rng) const {
    const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
    const double r = std::sqrt(rng.uniform());
    return mesh.surface_point(t, {r * rng.uniform(), 1 - r});
  }

  TriangleMesh mesh;
  HalfEdgeMesh half_edges;
  RayScene rays;

 private:
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Exact = CGAL::Surface_mesh<Kernel::Point_3>;
  using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Exact>;
  using Paths = CGAL::Surface_mesh_shortest_path<Traits>;

  /// CGAL counts a face's corners from the source of its first half-edge.
  Traits::Barycentric_coordinates weights(const SurfacePoint& p) const {
    const Vec2 b = p.barycentric;
    const double own[3] = {1 - b.x - b.y, b.x, b.y};
    const auto half_edge = exact_.halfedge(faces_[p.triangle]);
    const uint32_t first = exact_.source(half_edge);
    const Index3& c = mesh.corners[p.triangle];
    const std::size_t k = c[0] == first ? 0 : c[1] == first ? 1 : 2;
    return {own[k], own[(k + 1) % 3], own[(k + 2) % 3]};
  }

  Exact exact_;
  std::vector<Exact::Face_index> faces_;
};

struct Errors {
  double mean = 0, bias = 0, worst = 0;
  int count = 0, refused = 0;
};

/// Relative errors against the oracle, pairs between two distances apart.
Errors errors_of(Oracle& oracle, const Geodesic& method, double shortest, double longest, int sources = 6) {
  Rng rng(3);
  Errors errors;
  for (int s = 0; s < sources; ++s) {
    const SurfacePoint from = oracle.random_point(rng);
    std::vector<SurfacePoint> to;
    while (to.size() < 30) {
      const SurfacePoint p = oracle.random_point(rng);
      const double d = glm::distance(p.position, from.position);
      if (d >= shortest && d <= longest) to.push_back(p);
    }
    const auto exact = oracle.distances(from, to), found = method.distances(from, to);
    for (std::size_t i = 0; i < to.size(); ++i) {
      REQUIRE(exact[i]);
      if (!found[i]) {
        ++errors.refused;
        continue;
      }
      const double error = *found[i] / *exact[i] - 1;
      ++errors.count, errors.bias += error, errors.mean += std::abs(error);
      errors.worst = std::max(errors.worst, std::abs(error));
    }
  }
  errors.mean /= std::max(errors.count, 1), errors.bias /= std::max(errors.count, 1);
  return errors;
}

}  // namespace

TEST_CASE("exact distances meet great circles as a ball is refined", "[slow]") {
  double last = 1;
  for (const int resolution : {16, 32, 64}) {
    Oracle ball(make_blob(1, 0, resolution));
    Rng rng(1);
    const SurfacePoint from = ball.random_point(rng);
    std::vector<SurfacePoint> to;
    for (int i = 0; i < 40; ++i) to.push_back(ball.random_point(rng));
    const auto exact = ball.distances(from, to);
    double worst = 0;
    for (std::size_t i = 0; i < to.size(); ++i) {
      const Vec3 a = from.position, b = to[i].position;
      const double circle = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
      if (circle > 0.3) worst = std::max(worst, std::abs(*exact[i] / circle - 1));
    }
    CAPTURE(resolution, worst);
    CHECK(worst < 0.5 * last);
    last = worst;
  }
}

TEST_CASE("the Steiner graph converges to exact distances from above, on any triangles", "[slow]") {
  TriangleMesh obtuse = make_blob(1, 0.25, 12);  // flattened: obtuse triangles all over
  for (Vec3& p : obtuse.positions) p.y *= 0.15;
  TriangleMesh needles = make_plane(1, 8);
  for (Vec3& p : needles.positions) p.x *= 1e-2;
  for (const TriangleMesh& mesh :
       {make_blob(1, 0.25, 16), make_folded_sheet(2, 0.2, 0.1, 12), obtuse, needles}) {
    Oracle oracle(mesh);
    double last = 1;
    for (const int per_edge : {1, 3, 7}) {
      const Errors errors = errors_of(oracle, *make_steiner_graph(oracle.mesh, per_edge), 0.2, 5);
      CAPTURE(per_edge, errors.mean, errors.worst);
      CHECK(errors.refused == 0);
      CHECK(errors.bias >= -1e-9);
      CHECK(errors.mean < 0.6 * last);
      last = errors.mean;
    }
    CHECK(last < 0.01);
  }
}

TEST_CASE("how far the approximations are from exact distances on bumps", "[slow]") {
  Oracle blob(make_blob(1, 0.25, 32));
  struct Row {
    std::unique_ptr<Geodesic> method;
    double most_near, most_far;  // mean errors allowed at 0.05 to 0.15 and at 0.5 to 1.5
  };
  Row rows[] = {{make_chord(blob.mesh, blob.rays, 0), 0.01, 0.15},
                {make_normal_corrected_chord(blob.mesh, blob.rays, 0), 0.01, 0.08},
                {make_projected_chord(blob.mesh, blob.rays, 0), 0.01, 0.08},
                {make_straightest_path(blob.mesh, blob.half_edges), 1e-4, 0.002},
                {make_edge_graph(blob.mesh, blob.half_edges), 0.6, 0.2},
                {make_heat_method(blob.mesh, blob.half_edges), 0.4, 0.05},
                {make_steiner_graph(blob.mesh), 0.03, 0.008}};
  for (const Row& row : rows) {
    const Errors near = errors_of(blob, *row.method, 0.05, 0.15),
                 far = errors_of(blob, *row.method, 0.5, 1.5);
    std::printf(
        "%-24s near: mean %.3f %%, worst %.2f %%, refused %d; far: mean %.3f %%, worst %.2f %%, refused %d\n",
        std::string(row.method->name()).c_str(), 100 * near.mean, 100 * near.worst, near.refused,
        100 * far.mean, 100 * far.worst, far.refused);
    CAPTURE(row.method->name());
    CHECK(near.mean < row.most_near);
    CHECK(far.mean < row.most_far);
  }
}

TEST_CASE("the oracle knows what cannot be reached", "[slow]") {
  TriangleMesh pair = make_blob(1, 0, 8);
  const TriangleMesh other = pair;
  const auto base = static_cast<uint32_t>(pair.positions.size());
  for (const Vec3& p : other.positions) pair.positions.push_back(p + Vec3(2.01, 0, 0));
  for (const Index3& c : other.corners) pair.corners.push_back({base + c[0], base + c[1], base + c[2]});
  pair.attributes.insert(pair.attributes.end(), other.attributes.begin(), other.attributes.end());
  Oracle balls(pair);
  const SurfacePoint left = balls.mesh.surface_point(0, {0.3, 0.3});
  const auto on_other = static_cast<uint32_t>(other.triangle_count());
  const std::vector<SurfacePoint> to{balls.mesh.surface_point(on_other, {0.3, 0.3}),
                                     balls.mesh.surface_point(5, {0.3, 0.3})};
  const auto exact = balls.distances(left, to), ours = make_steiner_graph(balls.mesh)->distances(left, to);
  CHECK_FALSE(exact[0]);
  CHECK_FALSE(ours[0]);
  CHECK(exact[1]);
  CHECK(ours[1]);
}
