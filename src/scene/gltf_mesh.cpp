#include "scene/gltf_mesh.h"

#include <bit>
#include <cmath>
#include <glm/matrix.hpp>
#include <utility>

namespace alabaster {

namespace {

bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Inverse transpose up to a factor, defined for singular matrices too.
Mat3 cofactors(const Mat3& m) {
  return Mat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
}

Vec3 unit_or_zero(const Vec3& v) {
  const double length = glm::length(v);
  return finite(v) && length > 0 ? v / length : Vec3(0);
}

}  // namespace

struct GltfMeshBuilder::Source {
  const GltfPrimitive& primitive;
  const std::vector<Mat4>& transforms;
  std::size_t primary_uv_set;
  std::vector<uint32_t> attribute_of_vertex;  // no_index: not made yet

  const Mat4& transform(uint32_t vertex) const { return transforms[transforms.size() == 1 ? 0 : vertex]; }
  Vec3 position(uint32_t vertex) const {
    return Vec3(transform(vertex) * Vec4(primitive.positions[vertex], 1));
  }
  bool mirrored(uint32_t vertex) const { return glm::determinant(Mat3(transform(vertex))) < 0; }
  /// Zero when the primitive has none that could be used.
  Vec3 normal(uint32_t vertex) const {
    if (primitive.normals.empty()) return Vec3(0);
    const Mat3 linear(transform(vertex));
    const double sign = mirrored(vertex) ? -1 : 1;
    return unit_or_zero(sign * (cofactors(linear) * primitive.normals[vertex]));
  }
};

uint32_t GltfMeshBuilder::weld(const Vec3& p) {
  // Adding 0 turns -0 into 0: they are one place.
  const std::array<uint64_t, 3> key{std::bit_cast<uint64_t>(p.x + 0.0), std::bit_cast<uint64_t>(p.y + 0.0),
                                    std::bit_cast<uint64_t>(p.z + 0.0)};
  const auto [it, fresh] = position_index_.try_emplace(key, static_cast<uint32_t>(mesh_.positions.size()));
  if (fresh) mesh_.positions.push_back(p);
  return it->second;
}

void GltfMeshBuilder::grow_optional_arrays(const GltfPrimitive& primitive, std::size_t primary) {
  const std::size_t count = mesh_.normals.size();
  std::size_t sets = primitive.uv_sets.size();
  if (sets > 0) sets = std::max(sets, primary + 1);  // the swap may reach past the last set
  while (mesh_.uv_sets.size() < sets) mesh_.uv_sets.emplace_back(count, Vec2f(0));
  if (!primitive.colours.empty() && !has_colours_) {
    has_colours_ = true;
    mesh_.colours.assign(count, Vec4f(1));
  }
}

uint32_t GltfMeshBuilder::add_attribute(const Source& source, uint32_t vertex, const Vec3& normal) {
  const GltfPrimitive& primitive = source.primitive;
  const auto index = static_cast<uint32_t>(mesh_.normals.size());
  mesh_.normals.emplace_back(normal);
  for (std::size_t set = 0; set < mesh_.uv_sets.size(); ++set) {
    const std::size_t from = set == 0 ? source.primary_uv_set : set == source.primary_uv_set ? 0 : set;
    Vec2f uv(0);
    if (from < primitive.uv_sets.size() && !primitive.uv_sets[from].empty())
      uv = primitive.uv_sets[from][vertex];
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      ++counts_.non_finite_uvs;
      uv = Vec2f(0);
    }
    mesh_.uv_sets[set].push_back(uv);
  }
  if (has_colours_) mesh_.colours.push_back(primitive.colours.empty() ? Vec4f(1) : primitive.colours[vertex]);
  Vec4f tangent(0);
  if (!primitive.tangents.empty()) {
    const Vec4& t = primitive.tangents[vertex];
    const Vec3 direction = unit_or_zero(Mat3(source.transform(vertex)) * Vec3(t));
    tangent = Vec4f(Vec3f(direction), static_cast<float>(source.mirrored(vertex) ? -t.w : t.w));
  }
  mesh_.tangents.push_back(tangent);
  return index;
}

void GltfMeshBuilder::add_triangle(Source& source, Index3 triangle, uint16_t material) {
  if (source.mirrored(triangle[0])) std::swap(triangle[1], triangle[2]);
  std::array<Vec3, 3> p;
  for (std::size_t c = 0; c < 3; ++c) {
    p[c] = source.position(triangle[c]);
    if (!finite(p[c])) {
      ++counts_.non_finite_triangles;
      return;
    }
  }
  const Vec3 facet = unit_or_zero(glm::cross(p[1] - p[0], p[2] - p[0]));
  const Vec3 flat = facet == Vec3(0) ? Vec3(0, 0, 1) : facet;
  Index3 corners{}, attributes{};
  for (std::size_t c = 0; c < 3; ++c) {
    const uint32_t vertex = triangle[c];
    corners[c] = weld(p[c]);
    const Vec3 normal = source.normal(vertex);
    if (normal == Vec3(0)) {
      // glTF: without normals a primitive is flat, so corners cannot be shared.
      if (!source.primitive.normals.empty()) ++counts_.bad_normals;
      attributes[c] = add_attribute(source, vertex, flat);
    } else {
      uint32_t& known = source.attribute_of_vertex[vertex];
      if (known == no_index) known = add_attribute(source, vertex, normal);
      attributes[c] = known;
    }
  }
  mesh_.corners.push_back(corners);
  mesh_.attributes.push_back(attributes);
  mesh_.materials.push_back(material);
}

void GltfMeshBuilder::add(const GltfPrimitive& primitive, const std::vector<Mat4>& vertex_transforms,
                          uint16_t material, std::size_t primary_uv_set) {
  grow_optional_arrays(primitive, primary_uv_set);
  if (primitive.normals.empty()) ++counts_.flat_primitives;
  if (primitive.tangents.empty()) all_have_tangents_ = false;
  Source source{primitive, vertex_transforms, primary_uv_set,
                std::vector<uint32_t>(primitive.positions.size(), no_index)};
  for (const Index3& triangle : primitive.triangles) add_triangle(source, triangle, material);
}

TriangleMesh GltfMeshBuilder::finish(std::size_t tangent_uv_set) && {
  if (tangent_uv_set == no_index) {
    mesh_.tangents.clear();
  } else if (!all_have_tangents_) {
    mesh_.tangents.clear();
    compute_tangents(mesh_, tangent_uv_set);
  }
  return std::move(mesh_);
}

}  // namespace alabaster
