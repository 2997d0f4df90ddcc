#pragma once

#include "core/frame.h"
#include "integrators/ggx.h"
#include "scene/scene.h"

namespace alabaster {

/// A surface point seen by a ray, and what its material says there. Normals are turned to the side the ray
/// came from.
struct Interaction {
  SurfacePoint point;      // geometric and shading normal on the side of `towards_viewer`
  bool front = true;       // the ray came from the side of the mesh's own normals
  Vec3 towards_viewer{0};  // unit
  Vec3 mirror_normal{0};   // shading normal bent by the normal map: for the mirror term and Fresnel factors
  double cos_viewer = 0;   // to mirror_normal, > 0
  const Material* material = nullptr;
  uint16_t material_index = 0;
  Rgb base_colour;      // factor x texture x vertex colour
  double metallic = 0;  // [0, 1]
  Ggx roughness{1};
  double subsurface = 0;  // share of the body light that goes below the surface rather than being diffuse
};

/// Reads the material at a hit.
///
/// Shading normals that turn away from the viewer are bent back until they just do not: along silhouettes the
/// mirror term then takes over smoothly, instead of a black rim.
Interaction make_interaction(const Scene& scene, const Ray& ray, const Hit& hit);

/// The shading normal at a point of a mesh as the material's normal map bends it, on the side of the point's
/// geometric normal. `front` tells whether the point's normals are the mesh's own or turned round.
Vec3 mapped_normal(const Material& material, const TriangleMesh& mesh, const SurfacePoint& point, bool front);

/// Unit `w` mirrored at `normal`, bent back above the geometric surface where it would end below.
Vec3 mirror_direction(const Vec3& w, const Vec3& normal, const Vec3& geometric_normal);

}  // namespace alabaster
