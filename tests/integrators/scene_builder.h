#pragma once

#include <utility>

#include "core/statistics.h"
#include "geometry/shapes.h"
#include "integrators/surface.h"
#include "optics/profile_table.h"
#include "scene/scene.h"

namespace alabaster::test {

inline Material diffuse_material(const Rgb& colour, double roughness = 0, double metallic = 0) {
  Material m;
  m.name = "diffuse";
  m.base_colour_factor = {colour.r, colour.g, colour.b, 1};
  m.metallic_factor = metallic;
  m.roughness_factor = roughness;
  return m;
}

/// A medium whose alpha is the same everywhere.
inline Material medium_material(const Rgb& albedo, const Rgb& mean_free_path, double eta = 1.5) {
  Material m = diffuse_material(Rgb(0.5));
  m.name = "medium";
  m.medium = Medium{mean_free_path, 0.3, eta};
  m.albedo.meaning = AlbedoSource::Meaning::albedo;
  m.albedo.factor = albedo;
  m.ior = eta;
  return m;
}

inline Material emitter_material(const Rgb& radiance) {
  Material m = diffuse_material(Rgb(0));
  m.name = "emitter";
  m.emission = radiance;
  m.double_sided = true;
  m.ior = 1;
  return m;
}

/// Turns the mesh by a rotation, then moves it.
inline TriangleMesh placed(TriangleMesh mesh, const Vec3& offset, const Mat3& rotation = Mat3(1.0)) {
  for (Vec3& p : mesh.positions) p = rotation * p + offset;
  for (Vec3f& n : mesh.normals) n = Vec3f(rotation * Vec3(n));
  return mesh;
}

inline void add(Scene& scene, TriangleMesh mesh, Material material) {
  const auto index = static_cast<uint16_t>(scene.materials.size());
  scene.materials.push_back(std::move(material));
  mesh.materials.assign(mesh.triangle_count(), index);
  SceneObject object;
  object.name = "object" + std::to_string(scene.objects.size());
  object.mesh = std::move(mesh);
  scene.objects.push_back(std::move(object));
}

/// A camera of parallel rays that sees `target` from `direction_to_camera`, `height` metres of it.
inline Camera parallel_camera(const Vec3& target, const Vec3& direction_to_camera, double distance,
                              double height) {
  Camera camera;
  const Vec3 w = glm::normalize(direction_to_camera);
  camera.position = target + distance * w;
  camera.direction = -w;
  camera.up = std::abs(w.y) > 0.9 ? Vec3(0, 0, 1) : Vec3(0, 1, 0);
  camera.orthographic_height = height;
  return camera;
}

struct Measured {
  double mean = 0, error = 0;  // standard error
};

/// Mean of one channel over `count` independent samples of a one-pixel image.
inline Measured measure(const Scene& scene, SurfaceOptions options, int count, int channel = 0,
                        uint64_t seed = 1) {
  options.width = options.height = 1;
  const SurfaceIntegrator integrator(scene, options);
  Sampler sampler(SamplerKind::independent, seed);
  RunningMoments moments;
  for (int k = 0; k < count; ++k) {
    sampler.start(0, 0, static_cast<uint32_t>(k));
    const PixelSample s = integrator.sample(0, 0, sampler);
    moments.add(s.radiance[channel]);
  }
  return {moments.mean(), moments.standard_error()};
}

}  // namespace alabaster::test
