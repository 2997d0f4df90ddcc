#include "geometry/curvature.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/frame.h"
#include "core/parallel.h"
#include "geometry/half_edge_mesh.h"

namespace alabaster {

namespace {

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : otherwise;
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// A vertex as the fit sees it.
struct VertexSample {
  Vec3 position{0}, normal{0};
  double area = 0;  // a third of its triangles', m^2
};

/// Normals weighted by the angle at the vertex: they do not depend on how a face is cut into triangles.
std::vector<VertexSample> vertex_samples(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges) {
  std::vector<VertexSample> samples(half_edges.vertex_count());
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 normal = mesh.geometric_normal(t);
    const double area = mesh.area(t);
    for (int k = 0; k < 3; ++k) {
      const auto corner = [&](int i) {
        return mesh.positions[mesh.corners[t][static_cast<std::size_t>(i % 3)]];
      };
      VertexSample& sample = samples[half_edges.vertex(t, k)];
      sample.position = corner(k);
      sample.normal += normal * angle_between(corner(k + 1) - corner(k), corner(k + 2) - corner(k));
      sample.area += area / 3;
    }
  }
  for (VertexSample& sample : samples) sample.normal = unit_or(sample.normal, Vec3(0, 0, 1));
  return samples;
}

/// Vertices around one, by a walk along edges.
class Neighbourhood {
 public:
  Neighbourhood(const HalfEdgeMesh& half_edges, const std::vector<VertexSample>& samples, double radius,
                int max_vertices)
      : half_edges_(half_edges),
        samples_(samples),
        least_radius_(radius),
        limit_(static_cast<std::size_t>(std::max(max_vertices, 6))),
        visited_(samples.size(), no_index) {}

  /// Fills vertices() and radius(). The centre comes first.
  void gather(uint32_t centre) {
    const Vec3 origin = samples_[centre].position;
    half_edges_.ring(centre, ring_);
    double sum = 0, longest = 0;
    for (const uint32_t v : ring_) {
      const double length = glm::length(samples_[v].position - origin);
      sum += length, longest = std::max(longest, length);
    }
    const double mean = ring_.empty() ? 0 : sum / static_cast<double>(ring_.size());
    radius_ = std::max({least_radius_, 3 * mean, 1.5 * longest});
    vertices_.assign(1, centre);
    visited_[centre] = centre;
    for (std::size_t i = 0; i < vertices_.size() && vertices_.size() < limit_; ++i) {
      half_edges_.ring(vertices_[i], ring_);
      for (const uint32_t v : ring_) {
        if (visited_[v] == centre || glm::length(samples_[v].position - origin) >= radius_) continue;
        visited_[v] = centre;
        vertices_.push_back(v);
      }
    }
    if (vertices_.size() >= limit_) shrink_radius(origin);
  }

  const std::vector<uint32_t>& vertices() const { return vertices_; }
  double radius() const { return radius_; }

 private:
  /// The walk stopped early: weigh by the distance it reached.
  void shrink_radius(const Vec3& origin) {
    double farthest = 0;
    for (const uint32_t v : vertices_)
      farthest = std::max(farthest, glm::length(samples_[v].position - origin));
    radius_ = std::min(radius_, 1.001 * farthest);
  }

  const HalfEdgeMesh& half_edges_;
  const std::vector<VertexSample>& samples_;
  double least_radius_;
  std::size_t limit_;
  std::vector<uint32_t> visited_;  // the centre that last saw the vertex
  std::vector<uint32_t> vertices_, ring_;
  double radius_ = 0;
};

struct Fit {
  double curvature_min = 0, curvature_max = 0;
  Vec3 normal{0};
  double residual = 0;  // mean square of what is left of the normals
};

/// Weighted least squares of n_j = n + S (x_j - x) in the tangent plane of the first vertex.
/// Normals farther from the first one's than `least_cosine` are left out.
Fit fit_shape_operator(const std::vector<VertexSample>& samples, const std::vector<uint32_t>& vertices,
                       double radius, double least_cosine = -2) {
  const VertexSample& centre = samples[vertices[0]];
  const Frame frame(centre.normal);
  struct Row {
    Vec2 x, n;
    double weight;
  };
  const auto row_of = [&](uint32_t v) {
    const Vec3 x = frame.to_local(samples[v].position - centre.position);
    const Vec3 n = frame.to_local(samples[v].normal);
    const double r = n.z < least_cosine ? 1 : std::min(glm::length(x) / radius, 1.0);
    return Row{Vec2(x), Vec2(n), samples[v].area * (1 - r * r) * (1 - r * r)};
  };
  double sum = 0;
  Vec2 mean_x(0), mean_n(0);
  for (const uint32_t v : vertices) {
    const Row row = row_of(v);
    sum += row.weight, mean_x += row.weight * row.x, mean_n += row.weight * row.n;
  }
  if (!(sum > 0)) return {0, 0, centre.normal};
  mean_x /= sum, mean_n /= sum;
  Mat3 matrix(0.0);
  Vec3 right(0);
  for (const uint32_t v : vertices) {
    const Row row = row_of(v);
    const Vec2 x = row.x - mean_x, n = row.n - mean_n;
    const double w = row.weight;
    matrix += w * Mat3(x.x * x.x, x.x * x.y, 0, x.x * x.y, x.x * x.x + x.y * x.y, x.x * x.y, 0, x.x * x.y,
                       x.y * x.y);
    right += w * Vec3(x.x * n.x, x.y * n.x + x.x * n.y, x.y * n.y);
  }
  // A hint of a prior, S = 0, keeps too few or collinear vertices from blowing up.
  const double trace = matrix[0][0] + matrix[2][2];
  if (!(trace > 0)) return {0, 0, centre.normal};
  for (int k = 0; k < 3; ++k) matrix[k][k] += 1e-9 * trace;
  const Vec3 s = glm::inverse(matrix) * right;  // S11, S12, S22
  const double mean = 0.5 * (s.x + s.z), half_difference = 0.5 * (s.x - s.z);
  const double spread = std::hypot(half_difference, s.y);
  const Vec2 n = mean_n - Vec2(s.x * mean_x.x + s.y * mean_x.y, s.y * mean_x.x + s.z * mean_x.y);
  const Vec3 local(n, std::sqrt(std::max(1 - glm::dot(n, n), 0.0)));
  double residual = 0;
  for (const uint32_t v : vertices) {
    const Row row = row_of(v);
    const Vec2 x = row.x - mean_x;
    const Vec2 left = row.n - mean_n - Vec2(s.x * x.x + s.y * x.y, s.y * x.x + s.z * x.y);
    residual += row.weight * glm::dot(left, left) / sum;
  }
  return {mean - spread, mean + spread, unit_or(frame.to_world(local), centre.normal), residual};
}

/// 1 / the distance along -normal to where the object ends; 0 when it does not.
double inverse_thickness(const TriangleMesh& mesh, const RayScene& scene, uint32_t object,
                         const Vec3& position, const Vec3& normal, const std::vector<uint32_t>& fan,
                         std::vector<Hit>& hits) {
  Ray ray;
  ray.origin = position, ray.direction = -normal;
  scene.all_hits(object, ray, hits);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Hit& hit : hits) {
    const bool leaves = glm::dot(mesh.geometric_normal(hit.triangle), ray.direction) > 0;
    const bool own = std::find(fan.begin(), fan.end(), hit.triangle) != fan.end();
    if (leaves && !own && hit.t > 0) nearest = std::min(nearest, hit.t);
  }
  return 1 / nearest;
}

}  // namespace

CurvatureField::CurvatureField(const TriangleMesh& mesh, const RayScene& scene, uint32_t object,
                               const CurvatureOptions& options) {
  const HalfEdgeMesh half_edges(mesh);
  const std::vector<VertexSample> samples = vertex_samples(mesh, half_edges);
  vertex_of_corner_.resize(mesh.triangle_count());
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) vertex_of_corner_[t][static_cast<std::size_t>(k)] = half_edges.vertex(t, k);
  shapes_.resize(samples.size());
  // Few ranges: each holds a mark for every vertex.
  const std::size_t grain = samples.size() / (4 * static_cast<std::size_t>(thread_count())) + 1;
  parallel_for(samples.size(), grain, [&](std::size_t begin, std::size_t end) {
    Neighbourhood neighbourhood(half_edges, samples, options.radius, options.max_neighbours);
    Neighbourhood around(half_edges, samples, options.coarse_radius, 4 * options.max_neighbours);
    std::vector<uint32_t> fan;
    std::vector<Hit> hits;
    for (auto v = static_cast<uint32_t>(begin); v < end; ++v) {
      neighbourhood.gather(v);
      const Fit fit = fit_shape_operator(samples, neighbourhood.vertices(), neighbourhood.radius());
      half_edges.fan(v, fan);
      VertexShape& shape = shapes_[v];
      shape.curvature_min = static_cast<float>(fit.curvature_min);
      shape.curvature_max = static_cast<float>(fit.curvature_max);
      shape.normal = Vec3f(fit.normal);
      if (options.coarse_radius > 0) {
        // What is turned by more than 41 degrees is another side of the body, not a wrinkle.
        around.gather(v);
        const Fit coarse = fit_shape_operator(samples, around.vertices(), around.radius(), 0.75);
        shape.roughness = static_cast<float>(coarse.residual);
      }
      shape.inverse_thickness = static_cast<float>(
          inverse_thickness(mesh, scene, object, samples[v].position, fit.normal, fan, hits));
    }
  });
}

LocalShape CurvatureField::at(uint32_t triangle, Vec2 barycentric) const {
  const Index3& corner = vertex_of_corner_[triangle];
  const std::array<double, 3> weights{1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y};
  LocalShape shape;
  for (std::size_t k = 0; k < 3; ++k) {
    const VertexShape& vertex = shapes_[corner[k]];
    shape.curvature_min += weights[k] * double{vertex.curvature_min};
    shape.curvature_max += weights[k] * double{vertex.curvature_max};
    shape.inverse_thickness += weights[k] * double{vertex.inverse_thickness};
    shape.roughness += weights[k] * double{vertex.roughness};
    shape.normal += weights[k] * Vec3(vertex.normal);
  }
  shape.normal = unit_or(shape.normal, Vec3(shapes_[corner[0]].normal));
  return shape;
}

}  // namespace alabaster
