// Multiple importance sampling against each of its strategies alone: estimators written out here, which share
// with the integrator only its draws of lights and microfacets.

#include <catch2/catch.hpp>
#include <cmath>

#include "core/frame.h"
#include "integrators/scene_builder.h"
#include "optics/fresnel.h"

using namespace alabaster;
using namespace alabaster::test;

namespace {

const Vec3 up(0, 0, 1);

/// A plane below a sky and beside a tilted glowing square that hides part of it.
Scene lit_plane(const Material& material, bool sky) {
  Scene scene;
  add(scene, make_plane(40), material);
  const Mat3 facing_aside(Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(1, 0, 0));
  add(scene, placed(make_plane(2), Vec3(-1.5, 0.3, 1.2), facing_aside), emitter_material(Rgb(2, 1, 3)));
  if (sky) scene.environment = make_sky_environment({});
  prepare_scene(scene);
  return scene;
}

/// Light that arrives at the origin of the plane from `direction`, in the red channel.
double arriving(const Scene& scene, const LightSampler& lights, const Vec3& direction) {
  Ray ray;
  ray.origin = 1e-6 * up;
  ray.direction = direction;
  if (const auto hit = scene.rays.nearest(ray)) return lights.emitted(*hit, direction).r;
  return scene.environment ? scene.environment->radiance(direction).r : 0;
}

struct Strategies {
  RunningMoments light_alone, surface_alone;
};

/// `value` is what leaves per radiance that arrives, cosine included; `draw` gives a direction with its
/// density.
template <class Value, class Draw>
Strategies estimate(const Scene& scene, int count, const Value& value, const Draw& draw) {
  const LightSampler lights(scene);
  Strategies result;
  Rng rng(7);
  for (int i = 0; i < count; ++i) {
    const auto light = lights.sample(Vec3(0), up, rng.uniform(), {rng.uniform(), rng.uniform()});
    double sum = 0;
    if (light && light->direction.z > 0) {
      Ray ray;
      ray.origin = 1e-6 * up;
      ray.direction = light->direction;
      if (std::isfinite(light->distance)) ray.t_max = light->distance * (1 - 1e-4);
      if (!scene.rays.occluded(ray)) sum = value(light->direction) * light->radiance.r / light->pdf;
    }
    result.light_alone.add(sum);
    const HemisphereSample own = draw(Vec2(rng.uniform(), rng.uniform()));
    result.surface_alone.add(own.direction.z > 0 && own.pdf > 0
                                 ? value(own.direction) * arriving(scene, lights, own.direction) / own.pdf
                                 : 0);
  }
  return result;
}

/// `combined` is the integrator's own: its samples are independent of those here.
void check_agreement(const Strategies& alone, const Measured& combined) {
  const double significance = sidak(0.001, 12);
  for (const RunningMoments* m : {&alone.light_alone, &alone.surface_alone}) {
    const double z = (m->mean() - combined.mean) / std::hypot(m->standard_error(), combined.error);
    INFO(m->mean() << " +- " << m->standard_error() << " alone, " << combined.mean << " +- " << combined.error
                   << " combined");
    CHECK(m->standard_error() < 0.03 * m->mean());
    CHECK(two_sided_normal_p_value(z) > significance);
  }
}

}  // namespace

TEST_CASE("a rough mirror: lights and microfacets combined agree with either alone") {
  for (const bool sky : {false, true})
    for (const double roughness : {0.45, 0.9}) {
      const Scene scene = lit_plane(diffuse_material(Rgb(1), roughness, 1), sky);  // F = 1 at every angle
      const Vec3 wo = glm::normalize(Vec3(0.8, 0, 1));
      const Ggx ggx{roughness * roughness};
      const auto value = [&](const Vec3& wi) {
        const Vec3 h = glm::normalize(wo + wi);
        return ggx.distribution(h) * ggx.masking_shadowing(wo, wi) / (4 * wo.z);
      };
      const auto draw = [&](Vec2 u) {
        const Vec3 h = ggx.sample_visible_normal(wo, u), wi = 2 * glm::dot(wo, h) * h - wo;
        return HemisphereSample{wi, wi.z > 0 ? ggx.pdf_reflection(wo, wi) : 0};
      };
      SurfaceOptions options;
      options.camera = parallel_camera(Vec3(0), wo, 2, 1e-6);
      options.depth = 0;
      CAPTURE(sky, roughness);
      check_agreement(estimate(scene, 40000, value, draw), measure(scene, options, 40000));
    }
}

TEST_CASE("light that enters a body: lights and directions combined agree with either alone") {
  for (const bool sky : {false, true}) {
    const Scene scene = lit_plane(diffuse_material(Rgb(0.5)), sky);
    const double c = diffuse_transmittance(1.5), out = 1 - fresnel_dielectric(1, 1.5);
    const auto value = [&](const Vec3& wi) {
      return out / (pi * c) * 0.5 * (1 - fresnel_dielectric(wi.z, 1.5)) * wi.z;
    };
    const auto draw = [&](Vec2 u) {
      const Vec3 wi = cosine_direction(up, u);
      return HemisphereSample{wi, wi.z * inv_pi};
    };
    SurfaceOptions options;
    options.camera = parallel_camera(Vec3(0), up, 0.1, 1e-6);
    options.specular = false;
    options.depth = 0;
    CAPTURE(sky);
    check_agreement(estimate(scene, 40000, value, draw), measure(scene, options, 40000));
  }
}
