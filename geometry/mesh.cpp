#include "geometry/mesh.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

namespace {

/// Zero for a zero or non-finite vector, so that a broken triangle spreads no NaN.
Vec3 unit_or_zero(const Vec3& v) {
  const double squared = glm::dot(v, v);
  if (squared > 1e-200 && squared < 1e200) return v * (1 / std::sqrt(squared));
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0) || !std::isfinite(largest)) return Vec3(0);
  const Vec3 scaled = v / largest;  // no overflow or underflow in the square
  return scaled / glm::length(scaled);
}

/// Twice the area times the normal.
Vec3 area_vector(const TriangleMesh& mesh, std::size_t triangle) {
  const Index3& c = mesh.corners[triangle];
  const Vec3& a = mesh.positions[c[0]];
  return glm::cross(mesh.positions[c[1]] - a, mesh.positions[c[2]] - a);
}

/// In double, whatever the array stores.
template <class Double, class Stored>
Double interpolate(const std::vector<Stored>& values, const Index3& index, Vec2 barycentric) {
  return Double(values[index[0]]) * (1 - barycentric.x - barycentric.y) +
         Double(values[index[1]]) * barycentric.x + Double(values[index[2]]) * barycentric.y;
}

std::size_t attribute_count(const TriangleMesh& mesh) {
  std::size_t count = std::max({mesh.normals.size(), mesh.tangents.size(), mesh.colours.size()});
  for (const auto& set : mesh.uv_sets) count = std::max(count, set.size());
  for (const Index3& index : mesh.attributes)
    for (const uint32_t i : index) count = std::max(count, std::size_t{i} + 1);
  return count;
}

/// Makes `attributes` exist and every attribute array that is there equally long; returns that length.
std::size_t prepare_attributes(TriangleMesh& mesh) {
  if (mesh.attributes.size() != mesh.corners.size()) mesh.attributes = mesh.corners;
  const std::size_t count = attribute_count(mesh);
  mesh.normals.resize(count, Vec3f(0));
  for (auto& set : mesh.uv_sets) set.resize(count, Vec2f(0));
  if (!mesh.tangents.empty()) mesh.tangents.resize(count, Vec4f(0));
  if (!mesh.colours.empty()) mesh.colours.resize(count, Vec4f(1));
  return count;
}

/// Splits attributes whose corners need different values (the two sides of a mirror seam, the triangles of a
/// flat-shaded corner). State is what an attribute stands for; an unclaimed attribute takes the first asked.
template <class State>
class AttributeVariants {
 public:
  AttributeVariants(TriangleMesh& mesh, std::size_t count)
      : mesh_(mesh), state_(count), claimed_(count, false), next_(count, no_index) {}

  /// The attribute itself or the copy of it that stands for `wanted`.
  uint32_t variant(uint32_t attribute, const State& wanted) {
    while (claimed_[attribute] && !(state_[attribute] == wanted)) {
      if (next_[attribute] == no_index) next_[attribute] = duplicate(attribute);
      attribute = next_[attribute];
    }
    claimed_[attribute] = true;
    state_[attribute] = wanted;
    return attribute;
  }

 private:
  uint32_t duplicate(uint32_t attribute) {
    const auto append = [attribute](auto& array) {
      if (array.empty()) return;
      const auto value = array[attribute];  // by value: the array may move
      array.push_back(value);
    };
    append(mesh_.normals);
    for (auto& set : mesh_.uv_sets) append(set);
    append(mesh_.tangents);
    append(mesh_.colours);
    state_.emplace_back();
    claimed_.push_back(false);
    next_.push_back(no_index);
    return static_cast<uint32_t>(state_.size() - 1);
  }

  TriangleMesh& mesh_;
  std::vector<State> state_;
  std::vector<bool> claimed_;
  std::vector<uint32_t> next_;
};

}  // namespace

Vec3 TriangleMesh::position(uint32_t triangle, Vec2 barycentric) const {
  return interpolate<Vec3>(positions, corners[triangle], barycentric);
}

Vec3 TriangleMesh::geometric_normal(uint32_t triangle) const {
  return unit_or_zero(area_vector(*this, triangle));
}

double TriangleMesh::area(uint32_t triangle) const {
  return 0.5 * glm::length(area_vector(*this, triangle));
}

Vec2 TriangleMesh::uv(uint32_t triangle, Vec2 barycentric, std::size_t set) const {
  if (set >= uv_sets.size() || uv_sets[set].empty()) return Vec2(0);
  return interpolate<Vec2>(uv_sets[set], attributes[triangle], barycentric);
}

// All at once, since most of the time goes into fetching: as position(), geometric_normal() and uv() give it.
SurfacePoint TriangleMesh::surface_point(uint32_t triangle, Vec2 barycentric) const {
  const Index3& corner = corners[triangle];
  const Index3& attribute = attributes.empty() ? corner : attributes[triangle];
  const double w0 = 1 - barycentric.x - barycentric.y, w1 = barycentric.x, w2 = barycentric.y;
  const Vec3 &a = positions[corner[0]], &b = positions[corner[1]], &c = positions[corner[2]];
  SurfacePoint point;
  point.triangle = triangle;
  point.barycentric = barycentric;
  point.position = a * w0 + b * w1 + c * w2;
  point.geometric_normal = unit_or_zero(glm::cross(b - a, c - a));
  point.shading_normal = point.geometric_normal;
  if (!normals.empty()) {
    const Vec3 smooth = unit_or_zero(Vec3(normals[attribute[0]]) * w0 + Vec3(normals[attribute[1]]) * w1 +
                                     Vec3(normals[attribute[2]]) * w2);
    if (smooth != Vec3(0))
      point.shading_normal = glm::dot(smooth, point.geometric_normal) < 0 ? -smooth : smooth;
  }
  if (!uv_sets.empty() && !uv_sets.front().empty()) {
    const std::vector<Vec2f>& set = uv_sets.front();
    point.uv = Vec2(set[attribute[0]]) * w0 + Vec2(set[attribute[1]]) * w1 + Vec2(set[attribute[2]]) * w2;
  }
  return point;
}

BoundingBox bounding_box(const TriangleMesh& mesh) {
  BoundingBox box;
  for (const Index3& triangle : mesh.corners)
    for (const uint32_t corner : triangle) box.extend(mesh.positions[corner]);
  return box;
}

double surface_area(const TriangleMesh& mesh) {
  double sum = 0;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) sum += mesh.area(t);
  return sum;
}

double enclosed_volume(const TriangleMesh& mesh) {
  if (mesh.corners.empty()) return 0;
  // Tetrahedra over a point of the mesh: over the far-away origin they would cancel badly.
  const Vec3 apex = mesh.positions[mesh.corners[0][0]];
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    sum += glm::dot(mesh.positions[mesh.corners[t][0]] - apex, area_vector(mesh, t));
  return sum / 6;
}

void compute_smooth_normals(TriangleMesh& mesh) {
  AttributeVariants<uint32_t> variants(mesh, prepare_attributes(mesh));
  std::vector<Vec3> sums(mesh.positions.size(), Vec3(0));
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 weight = area_vector(mesh, t);
    if (!(length_squared(weight) >= 0)) continue;
    for (const uint32_t corner : mesh.corners[t]) sums[corner] += weight;
  }
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const uint32_t corner = mesh.corners[t][k];
      const Vec3 normal = unit_or_zero(sums[corner]);
      const uint32_t attribute = mesh.attributes[t][k] = variants.variant(mesh.attributes[t][k], corner);
      mesh.normals[attribute] = Vec3f(normal != Vec3(0) ? normal : Vec3(0, 0, 1));
    }
}

void compute_flat_normals(TriangleMesh& mesh) {
  AttributeVariants<Vec3f> variants(mesh, prepare_attributes(mesh));
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 geometric = mesh.geometric_normal(t);
    const Vec3f normal(geometric != Vec3(0) ? geometric : Vec3(0, 0, 1));
    for (uint32_t& attribute : mesh.attributes[t]) {
      attribute = variants.variant(attribute, normal);
      mesh.normals[attribute] = normal;
    }
  }
}

namespace {

/// dP/du of a triangle, weighted by its area in space, and whether its UVs are mirrored; zero where the UVs
/// have no area.
struct TriangleTangent {
  Vec3 direction{0};
  bool mirrored = false;
};

TriangleTangent triangle_tangent(const TriangleMesh& mesh, std::size_t t, std::size_t set) {
  const Index3 &c = mesh.corners[t], &a = mesh.attributes[t];
  const Vec3 e1 = mesh.positions[c[1]] - mesh.positions[c[0]],
             e2 = mesh.positions[c[2]] - mesh.positions[c[0]];
  const Vec2 base(mesh.uv_sets[set][a[0]]);
  const Vec2 d1 = Vec2(mesh.uv_sets[set][a[1]]) - base, d2 = Vec2(mesh.uv_sets[set][a[2]]) - base;
  const double determinant = d1.x * d2.y - d1.y * d2.x;
  if (determinant == 0 || !std::isfinite(determinant)) return {};
  const Vec3 direction = unit_or_zero((e1 * d2.y - e2 * d1.y) * (determinant < 0 ? -1.0 : 1.0));
  // glTF's v runs downwards in the image, so an unmirrored triangle has a negative determinant in UV space.
  return {direction * glm::length(glm::cross(e1, e2)), determinant > 0};
}

Vec3 any_perpendicular(const Vec3& n) {
  return unit_or_zero(std::abs(n.x) > 0.5 ? glm::cross(n, Vec3(0, 1, 0)) : glm::cross(n, Vec3(1, 0, 0)));
}

}  // namespace

void compute_tangents(TriangleMesh& mesh, std::size_t set) {
  const std::size_t count = prepare_attributes(mesh);
  mesh.tangents.assign(count, Vec4f(0, 0, 0, 1));
  const bool has_uv = set < mesh.uv_sets.size() && !mesh.uv_sets[set].empty();
  AttributeVariants<bool> mirrored(mesh, count);
  std::vector<Vec3> sums(count, Vec3(0));
  for (std::size_t t = 0; has_uv && t < mesh.triangle_count(); ++t) {
    const TriangleTangent tangent = triangle_tangent(mesh, t, set);
    if (tangent.direction == Vec3(0)) continue;
    for (uint32_t& attribute : mesh.attributes[t]) {
      attribute = mirrored.variant(attribute, tangent.mirrored);
      if (attribute >= sums.size()) sums.resize(attribute + 1, Vec3(0));
      sums[attribute] += tangent.direction;
      mesh.tangents[attribute].w = tangent.mirrored ? -1.0f : 1.0f;
    }
  }
  sums.resize(mesh.tangents.size(), Vec3(0));
  for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
    const Vec3 normal = unit_or_zero(Vec3(mesh.normals[i]));
    const Vec3 projected = unit_or_zero(sums[i] - normal * glm::dot(normal, sums[i]));
    const Vec3 tangent = projected != Vec3(0) ? projected : any_perpendicular(normal);
    mesh.tangents[i] = Vec4f(Vec3f(tangent), mesh.tangents[i].w);
  }
}

}  // namespace alabaster
