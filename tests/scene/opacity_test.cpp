#include <catch2/catch.hpp>
#include <cmath>

#include "core/rng.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "scene/scene.h"

using namespace alabaster;

namespace {

/// Squares one above the other at z = 0, 1, ...
Scene stack_of_squares(int count, const Material& material) {
  Scene scene;
  scene.materials.push_back(material);
  for (int i = 0; i < count; ++i) {
    SceneObject object;
    object.name = "square";
    object.mesh = make_plane(2);
    for (Vec3& p : object.mesh.positions) p.z += i;
    scene.objects.push_back(std::move(object));
  }
  prepare_scene(scene);
  return scene;
}

Ray downwards() {
  Ray ray;
  ray.origin = {0.3, 0.2, 10};
  ray.direction = {0, 0, -1};
  return ray;
}

}  // namespace

TEST_CASE("blended layers let rays through independently, one random number for all of them") {
  Material veil;
  veil.alpha_mode = AlphaMode::blend;
  veil.base_colour_factor.a = 0.5;
  const Scene scene = stack_of_squares(3, veil);
  Rng rng(11);
  RunningMoments blocked, first;
  for (int i = 0; i < 20000; ++i) {
    const double random = rng.uniform_positive();
    blocked.add(scene.rays.occluded(downwards(), random) ? 1 : 0);
    const auto hit = scene.rays.nearest(downwards(), random);
    CHECK(hit.has_value() == (blocked.count() > 0 && scene.rays.occluded(downwards(), random)));
    first.add(hit && hit->object == 2 ? 1 : 0);
  }
  CHECK(two_sided_normal_p_value((blocked.mean() - 0.875) / blocked.standard_error()) > 1e-5);
  CHECK(two_sided_normal_p_value((first.mean() - 0.5) / first.standard_error()) > 1e-5);
  // Without a random number everything that is there at all counts: probes.
  CHECK(scene.rays.nearest(downwards())->object == 2);
}

TEST_CASE("a vertex's alpha and the cut-off decide what a mask shows") {
  Material leaf;
  leaf.alpha_mode = AlphaMode::mask;
  leaf.alpha_cutoff = 0.4;
  leaf.base_colour_factor.a = 0.8;
  Scene scene;
  scene.materials.push_back(leaf);
  SceneObject object;
  object.mesh = make_plane(2);
  // Alpha runs from 0 at x = -1 to 1 at x = 1: shown where 0.8 alpha >= 0.4, for x >= 0.
  object.mesh.colours.resize(object.mesh.normals.size());
  for (std::size_t t = 0; t < object.mesh.triangle_count(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = object.mesh.positions[object.mesh.corners[t][c]].x;
      object.mesh.colours[object.mesh.attributes[t][c]] = Vec4f(1, 1, 1, static_cast<float>(0.5 * (x + 1)));
    }
  scene.objects.push_back(std::move(object));
  prepare_scene(scene);
  for (const double x : {-0.9, -0.3, -0.01, 0.01, 0.4, 0.9}) {
    Ray ray = downwards();
    ray.origin.x = x;
    CHECK(scene.rays.nearest(ray, 0.7).has_value() == (x > 0));
    CHECK(scene.rays.occluded(ray, 0.7) == (x > 0));
    std::vector<Hit> hits;
    ray.t_max = 20;
    scene.rays.all_hits(0, ray, hits);
    CHECK(hits.size() == (x > 0 ? 1u : 0u));
  }
}

TEST_CASE("emissive triangles are lights, and only they") {
  Material glow;
  glow.emission = Rgb(3, 2, 1);
  const Scene scene = stack_of_squares(2, glow);
  CHECK(scene.lights.size() == 4);
  CHECK(emission(glow, scene.objects[0].mesh, 0, {0.2, 0.2}) == Rgb(3, 2, 1));
  CHECK(stack_of_squares(2, Material{}).lights.empty());
}
