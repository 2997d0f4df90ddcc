// The volumetric reference on a flat sheet somewhere in space is the volumetric reference of the half-space.

#include <catch2/catch.hpp>

#include "geometry/shapes.h"
#include "integrators/planar_volume.h"
#include "integrators/render.h"
#include "integrators/surface.h"
#include "study/scene_sets.h"
#include "support/planar_in_space.h"
#include "support/z_test.h"

using namespace alabaster;

namespace {

// The plane of a flat scene, 110 mean free paths wide, as a sheet in space.
Scene sheet_in_space(const PlanarScene& planar) {
  TriangleMesh sheet = make_plane(110, 11);
  auto& uvs = sheet.uv_sets.at(0);
  for (std::size_t i = 0; i < uvs.size(); ++i) uvs[i] = Vec2f(planar.uv(Vec2(sheet.positions[i])));
  return planar_in_space(planar, std::move(sheet));
}

// Of the difference of the sums over all pixels: sees a small error of brightness that no pixel shows.
// Stripes are grey, so that channels of a walk are one; the first is taken.
double whole_image_p_value(const Image& a, const Image& b) {
  double difference = 0, variance = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      difference += static_cast<double>(a.at(a.find("R"), x, y)) - b.at(b.find("R"), x, y);
      variance += static_cast<double>(a.at(a.find("variance.R"), x, y)) + b.at(b.find("variance.R"), x, y);
    }
  return two_sided_normal_p_value(difference / std::sqrt(variance));
}

}  // namespace

TEST_CASE(
    "stripes1 by the reference on meshes is stripes1 by the reference of the plane (z-test per pixel, Sidak "
    "1e-3)") {
  PlanarScene planar = make_planar_study_scene("stripes1", 8);
  planar.view.size = Vec2(4);
  PlanarVolume on_plane(planar, {});
  on_plane.run(2'000'000);

  const Scene scene = sheet_in_space(planar);
  SurfaceOptions surface;
  surface.width = surface.height = 8;
  surface.camera = scene.cameras[0];
  surface.transport = Transport::volume;
  surface.walk.open_sheets = true;
  surface.depth = 0;
  surface.specular = false;
  RenderOptions options;
  options.sampler = SamplerKind::independent;
  options.spp = 8192;
  options.seed = 5;
  for (const bool exact : {true, false}) {
    surface.walk.closest_point = exact ? ClosestPointMode::exact : ClosestPointMode::cached;
    const Image on_mesh = render(SurfaceIntegrator(scene, surface), options).film.develop();
    const ZTest z = z_test(on_mesh, on_plane.develop(), 31);  // the plane's variance is of 32 batches
    INFO((exact ? "exact: " : "cached: ") << z.where << ", mean square " << z.mean_square);
    CHECK(z.tests == 3 * 64);
    CHECK(z.passes());
    CHECK(z.mean_square < 1.5);
    CHECK(whole_image_p_value(on_mesh, on_plane.develop()) > 1e-4);
  }
}
