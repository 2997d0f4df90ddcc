// The surface integrator on a flat quad somewhere in space is the planar integrator.

#include <catch2/catch.hpp>

#include "bssrdf/placements.h"
#include "geometry/shapes.h"
#include "integrators/planar.h"
#include "integrators/render.h"
#include "integrators/surface.h"
#include "support/planar_in_space.h"
#include "support/planar_scenes.h"
#include "support/z_test.h"
#include "texture/material_map.h"

using namespace alabaster;

namespace {

struct QuadScene {
  PlanarScene planar;
  Place place;
  Scene scene;

  QuadScene() : planar(coloured_planar_scene()) {
    planar.tile = Vec2(10);
    scene = planar_in_space(planar, make_plane(10, 6), place);
  }

  /// The surface point of the mesh at a place of the plane.
  SurfacePoint surface(Vec2 p) const {
    const auto hit = scene.rays.closest_point(0, place.point(Vec3(p, 0)));
    REQUIRE(hit);
    return scene.objects[0].mesh.surface_point(hit->triangle, hit->barycentric);
  }
};

}  // namespace

TEST_CASE("for the same pairs, a quad in space has the plane's S_V") {
  const QuadScene quad;
  const SceneObject& object = quad.scene.objects[0];
  const ChordPlacement placement({&object.mesh, &object.atlas, &quad.scene.rays, 0});
  CHECK(dynamic_cast<const TextureAlbedo*>(object.albedo.get()) != nullptr);  // its own pyramid is exact
  BssrdfOptions options;
  options.placement = &placement;
  const double area = quad.place.scale * quad.place.scale;
  for (const char* name :
       {"homogeneous", "factorized", "aggregate", "composite", "composite:symmetric", "composite:view"}) {
    const BssrdfMedium medium{&baseline_profile(), Rgb(1 / quad.place.scale), object.albedo.get()};
    const auto on_mesh = make_bssrdf(name, medium, options);
    const PlanarModel on_plane(quad.planar, name, baseline_profile());
    Rng rng(11);
    for (int i = 0; i < 300; ++i) {
      const Vec2 a(8 * rng.uniform() - 4, 8 * rng.uniform() - 4),
          b(8 * rng.uniform() - 4, 8 * rng.uniform() - 4);
      const BssrdfPoint mesh_a = medium.point(quad.surface(a)), plane_a = on_plane.point(a);
      BssrdfPoint mesh_b = medium.point(quad.surface(b)), plane_b = on_plane.point(b);
      plane_b.towards_viewer = glm::normalize(Vec3(rng.uniform() - 0.5, rng.uniform() - 0.5, 0.3));
      mesh_b.towards_viewer = quad.place.rotation * plane_b.towards_viewer;
      const Rgb mesh = area * on_mesh->evaluate(mesh_a, mesh_b);
      const Rgb plane = on_plane.bssrdf().evaluate(plane_a, plane_b);
      INFO(name << " from (" << a.x << ", " << a.y << ") to (" << b.x << ", " << b.y << ")");
      for (int c = 0; c < 3; ++c) REQUIRE(mesh[c] == Approx(plane[c]).epsilon(1e-5));
    }
  }
}

TEST_CASE(
    "with its own sampling, the surface integrator shows the planar image (z-test per pixel, Sidak 1e-3)") {
  const QuadScene quad;
  for (const char* name : {"homogeneous", "composite"}) {
    SurfaceOptions surface;
    surface.width = surface.height = 8;
    surface.camera = quad.scene.cameras[0];
    surface.model = name;
    surface.depth = 0;
    surface.specular = false;
    RenderOptions options;
    options.sampler = SamplerKind::independent;
    options.spp = 2048;
    options.seed = 1;
    const Image on_mesh = render(SurfaceIntegrator(quad.scene, surface), options).film.develop();
    const PlanarModel model(quad.planar, name, baseline_profile());
    options.seed = 2;
    options.spp = 512;
    const Image on_plane = render(PlanarIntegrator(model, PlanarSampling::clipped), options).film.develop();
    const ZTest z = z_test(on_mesh, on_plane, 511);
    INFO(name << ": " << z.where << ", mean square " << z.mean_square);
    CHECK(z.passes());
    CHECK(z.mean_square < 1.5);
  }
}
