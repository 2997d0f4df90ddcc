#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "geometry/geodesic.h"
#include "geometry/mesh_edges.h"

namespace alabaster {

namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Solver = Eigen::SimplicialLDLT<SparseMatrix>;

/// Heat flows from the source for a short time; its gradient, made unit, points away from the source; the
/// distance is the function whose gradient is nearest to that (a Poisson equation).
class HeatMethod final : public Geodesic {
 public:
  HeatMethod(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges);
  std::string_view name() const override { return "heat method"; }
  std::optional<double> distance(const SurfacePoint& from, const SurfacePoint& to) const override {
    return distances(from, {&to, 1}).front();
  }
  std::vector<std::optional<double>> distances(const SurfacePoint& from,
                                               std::span<const SurfacePoint> to) const override;

 private:
  struct Element {
    Index3 vertex;
    std::array<Vec3, 3> corner;
    std::array<double, 3> cotangent;  // of the angle at each corner
    Vec3 area_vector;                 // twice the area times the normal
  };
  static Element element(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges, uint32_t t);
  double interpolate(const Eigen::VectorXd& values, const SurfacePoint& point) const;
  Eigen::VectorXd divergence_of_directions(const Eigen::VectorXd& heat) const;

  std::vector<Element> elements_;
  std::vector<uint32_t> component_;  // by vertex
  std::size_t vertex_count_;
  Solver heat_, poisson_;
};

HeatMethod::Element HeatMethod::element(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges,
                                        uint32_t t) {
  Element e;
  for (std::size_t k = 0; k < 3; ++k) {
    e.vertex[k] = half_edges.vertex(t, static_cast<int>(k));
    e.corner[k] = mesh.positions[mesh.corners[t][k]];
  }
  e.area_vector = glm::cross(e.corner[1] - e.corner[0], e.corner[2] - e.corner[0]);
  const double twice_area = glm::length(e.area_vector);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 a = e.corner[(k + 1) % 3] - e.corner[k], b = e.corner[(k + 2) % 3] - e.corner[k];
    // A needle's cotangent is bounded, so that it conducts but does not spoil the equations.
    e.cotangent[k] = std::clamp(glm::dot(a, b) / std::max(twice_area, 1e-300), -1e4, 1e4);
  }
  return e;
}

HeatMethod::HeatMethod(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges)
    : vertex_count_(half_edges.vertex_count()) {
  using Triplet = Eigen::Triplet<double>;
  std::vector<Triplet> laplacian, mass;
  DisjointSets sets(vertex_count_);
  double edge_squared = 0;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Element& e = elements_.emplace_back(element(mesh, half_edges, t));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;  // the edge opposite corner k
      const int vi = static_cast<int>(e.vertex[i]), vj = static_cast<int>(e.vertex[j]);
      const double weight = 0.5 * e.cotangent[k];
      laplacian.emplace_back(vi, vi, weight);
      laplacian.emplace_back(vj, vj, weight);
      laplacian.emplace_back(vi, vj, -weight);
      laplacian.emplace_back(vj, vi, -weight);
      mass.emplace_back(vi, vi, glm::length(e.area_vector) / 6);
      sets.unite(e.vertex[i], e.vertex[j]);
      edge_squared += length_squared(e.corner[j] - e.corner[i]);
    }
  }
  sets.number(component_);
  if (elements_.empty()) return;
  const auto n = static_cast<int>(vertex_count_);
  SparseMatrix l(n, n), m(n, n);
  l.setFromTriplets(laplacian.begin(), laplacian.end());
  m.setFromTriplets(mass.begin(), mass.end());
  // The time of Crane et al. 2013, section 3.2.4: the squared mean edge.
  const double time = edge_squared / static_cast<double>(3 * elements_.size());
  heat_.compute(m + time * l);
  // Constants solve the Poisson equation of each component; a trace of mass picks one of them.
  poisson_.compute(l + (1e-9 / time) * m);
  if (heat_.info() != Eigen::Success || poisson_.info() != Eigen::Success)
    throw std::runtime_error("heat method: the mesh's equations cannot be solved");
}

double HeatMethod::interpolate(const Eigen::VectorXd& values, const SurfacePoint& point) const {
  const Index3& v = elements_[point.triangle].vertex;
  const Vec2 b = point.barycentric;
  return values[v[0]] * (1 - b.x - b.y) + values[v[1]] * b.x + values[v[2]] * b.y;
}

/// Integrated divergence of -grad heat / |grad heat| at the vertices (Crane et al. 2013, section 3.2.2).
Eigen::VectorXd HeatMethod::divergence_of_directions(const Eigen::VectorXd& heat) const {
  Eigen::VectorXd divergence = Eigen::VectorXd::Zero(heat.size());
  for (const Element& e : elements_) {
    Vec3 gradient(0);
    // Heat falls below the smallest double far away: compare within the triangle.
    const double scale =
        std::max({std::abs(heat[e.vertex[0]]), std::abs(heat[e.vertex[1]]), std::abs(heat[e.vertex[2]])});
    if (!(scale > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k)
      gradient += (heat[e.vertex[k]] / scale) *
                  glm::cross(e.area_vector, e.corner[(k + 2) % 3] - e.corner[(k + 1) % 3]);
    const double length = glm::length(gradient);
    if (!(length > 0)) continue;
    const Vec3 away = -gradient / length;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      divergence[e.vertex[k]] += 0.5 * (e.cotangent[j] * glm::dot(e.corner[i] - e.corner[k], away) +
                                        e.cotangent[i] * glm::dot(e.corner[j] - e.corner[k], away));
    }
  }
  return divergence;
}

std::vector<std::optional<double>> HeatMethod::distances(const SurfacePoint& from,
                                                         std::span<const SurfacePoint> to) const {
  Eigen::VectorXd source = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(vertex_count_));
  const Element& start = elements_[from.triangle];
  const Vec2 b = from.barycentric;
  const std::array<double, 3> weights{1 - b.x - b.y, b.x, b.y};
  for (std::size_t k = 0; k < 3; ++k) source[start.vertex[k]] += weights[k];
  const Eigen::VectorXd distance = poisson_.solve(-divergence_of_directions(heat_.solve(source)));
  // The function is 0 at the source; a corner's distance is known exactly and fixes the constant best.
  double offset = 0;
  for (std::size_t k = 0; k < 3; ++k)
    offset += weights[k] * (distance[start.vertex[k]] - glm::length(start.corner[k] - from.position));
  std::vector<std::optional<double>> result;
  result.reserve(to.size());
  for (const SurfacePoint& target : to) {
    if (component_[elements_[target.triangle].vertex[0]] != component_[start.vertex[0]])
      result.emplace_back(std::nullopt);
    else if (target.triangle == from.triangle)
      result.emplace_back(glm::length(target.position - from.position));
    else
      result.emplace_back(std::max(interpolate(distance, target) - offset, 0.0));
  }
  return result;
}

}  // namespace

std::unique_ptr<Geodesic> make_heat_method(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges) {
  return std::make_unique<HeatMethod>(mesh, half_edges);
}

}  // namespace alabaster
