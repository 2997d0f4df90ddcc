// The volumetric reference on a flat sheet somewhere in space is the volumetric reference of the half-space.

#include <catch2/catch.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "geometry/shapes.h"
#include "integrators/planar_volume.h"
#include "integrators/render.h"
#include "integrators/surface.h"
#include "study/scene_recipe.h"
#include "study/scene_sets.h"
#include "support/z_test.h"

using namespace alabaster;

namespace {

// The plane of a flat scene, 110 mean free paths wide, as a sheet that was rotated, shrunk and moved.
Scene sheet_in_space(const PlanarScene& planar) {
  const double scale = 0.03;
  const Mat3 rotation = Mat3(glm::rotate(Mat4(1), 0.9, glm::normalize(Vec3(1, 2, -0.5))));
  const auto place = [&](const Vec3& p) { return Vec3(0.4, -1.1, 2.3) + scale * (rotation * p); };

  SceneRecipe recipe;
  recipe.id = "sheet";
  RecipePart part;
  part.name = "sheet";
  part.mesh = make_plane(110, 11);
  auto& uvs = part.mesh.uv_sets.at(0);
  for (std::size_t i = 0; i < uvs.size(); ++i) uvs[i] = Vec2f(planar.uv(Vec2(part.mesh.positions[i])));
  for (Vec3& p : part.mesh.positions) p = place(p);
  for (Vec3f& n : part.mesh.normals) n = Vec3f(rotation * Vec3(n));
  part.medium = planar.medium;
  part.medium->mean_free_path *= scale;
  part.texture = planar.albedo;
  part.meaning = AlbedoSource::Meaning::albedo;
  part.roughness = 0;
  recipe.parts.push_back(part);
  recipe.sky.ambient = recipe.sky.key = Rgb(0);
  recipe.lights.push_back(PatchLight{place(Vec3(0)), planar.light.radius * scale, Rgb(1)});
  recipe.camera.position = place(Vec3(0, 0, 3));
  recipe.camera.direction = rotation * Vec3(0, 0, -1);
  recipe.camera.up = rotation * Vec3(0, 1, 0);
  recipe.camera.orthographic_height = planar.view.size.y * scale;
  return build_scene(std::move(recipe));
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
