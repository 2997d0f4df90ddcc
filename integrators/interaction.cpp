#include "integrators/interaction.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

namespace {

// The smallest cosine at which a surface may be seen; beyond it normals and reflections are bent back.
constexpr double grazing = 0.01;

// The direction nearest to `v` whose cosine to unit `axis` is at least `grazing`.
Vec3 bent_towards(const Vec3& v, const Vec3& axis) {
  const double cosine = glm::dot(v, axis);
  if (cosine >= grazing) return v;
  const Vec3 across = v - cosine * axis;
  const double length2 = length_squared(across);
  if (length2 < 1e-20) return axis;
  return grazing * axis + std::sqrt((1 - grazing * grazing) / length2) * across;
}

Vec4 texel(const std::shared_ptr<const Texture>& texture, const TriangleMesh& mesh, uint32_t triangle,
           Vec2 barycentric) {
  return texture->evaluate(mesh.uv(triangle, barycentric, texture->mapping().uv_set));
}

Rgb colour_at(const Material& m, const TriangleMesh& mesh, uint32_t triangle, Vec2 b) {
  Vec4 colour = m.base_colour_factor;
  if (m.base_colour) colour *= texel(m.base_colour, mesh, triangle, b);
  if (!mesh.colours.empty()) {
    const Index3& a = mesh.attributes[triangle];
    colour *= Vec4((1 - b.x - b.y) * Vec4(mesh.colours[a[0]]) + b.x * Vec4(mesh.colours[a[1]]) +
                   b.y * Vec4(mesh.colours[a[2]]));
  }
  return {colour.x, colour.y, colour.z};
}

}  // namespace

Vec3 mirror_direction(const Vec3& w, const Vec3& normal, const Vec3& geometric_normal) {
  return bent_towards(2 * glm::dot(w, normal) * normal - w, geometric_normal);
}

Vec3 mapped_normal(const Material& material, const TriangleMesh& mesh, const SurfacePoint& point,
                   bool front) {
  if (!material.normal || mesh.tangents.empty()) return point.shading_normal;
  const Vec3 normal = front ? point.shading_normal : -point.shading_normal;
  const Index3& a = mesh.attributes[point.triangle];
  const Vec2 b = point.barycentric;
  const Vec4 t = (1 - b.x - b.y) * Vec4(mesh.tangents[a[0]]) + b.x * Vec4(mesh.tangents[a[1]]) +
                 b.y * Vec4(mesh.tangents[a[2]]);
  const Vec3 tangent = Vec3(t) - glm::dot(Vec3(t), normal) * normal;
  const double length2 = length_squared(tangent);
  if (length2 < 1e-12) return point.shading_normal;
  const Vec3 unit_tangent = tangent / std::sqrt(length2);
  const Vec3 bitangent = (t.w < 0 ? -1.0 : 1.0) * glm::cross(normal, unit_tangent);
  const Vec4 map = texel(material.normal, mesh, point.triangle, b);
  const Vec3 local = 2.0 * Vec3(map) - 1.0;
  const Vec3 mapped = material.normal_scale * (local.x * unit_tangent + local.y * bitangent) +
                      std::max(local.z, 1e-3) * normal;
  return glm::normalize(front ? mapped : -mapped);
}

Interaction make_interaction(const Scene& scene, const Ray& ray, const Hit& hit) {
  const TriangleMesh& mesh = scene.objects[hit.object].mesh;
  Interaction it;
  it.point = mesh.surface_point(hit.triangle, hit.barycentric);
  it.point.object = hit.object;
  it.towards_viewer = -glm::normalize(ray.direction);
  it.front = glm::dot(it.point.geometric_normal, it.towards_viewer) >= 0;
  if (!it.front) {
    it.point.geometric_normal = -it.point.geometric_normal;
    it.point.shading_normal = -it.point.shading_normal;
  }
  it.material_index = mesh.materials[hit.triangle];
  it.material = &scene.materials[it.material_index];
  const Material& m = *it.material;
  it.point.shading_normal = bent_towards(it.point.shading_normal, it.towards_viewer);
  it.mirror_normal = bent_towards(mapped_normal(m, mesh, it.point, it.front), it.towards_viewer);
  it.cos_viewer = std::min(1.0, glm::dot(it.mirror_normal, it.towards_viewer));
  it.base_colour = colour_at(m, mesh, hit.triangle, hit.barycentric);
  it.metallic = m.metallic_factor;
  double roughness = m.roughness_factor;
  if (m.metallic_roughness) {
    const Vec4 value = texel(m.metallic_roughness, mesh, hit.triangle, hit.barycentric);
    roughness *= value.y;
    it.metallic *= value.z;
  }
  it.roughness.alpha = roughness * roughness;
  if (m.medium)
    it.subsurface = m.subsurface_map
                        ? std::clamp(texel(m.subsurface_map, mesh, hit.triangle, hit.barycentric).x, 0.0, 1.0)
                        : 1.0;
  return it;
}

}  // namespace alabaster
