#include "geometry/uv_atlas.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "geometry/shapes.h"
#include "support/nasty_meshes.h"

using namespace alabaster;

TEST_CASE("charts of the procedural shapes", "[uv_atlas]") {
  CHECK(UvAtlas(make_plane(1, 4)).chart_count() == 1);
  CHECK(UvAtlas(make_blob(1, 0.1, 24)).chart_count() == 6);
  CHECK(UvAtlas(make_blob(1, 0.1, 24)).overlap_fraction == 0);
  CHECK(UvAtlas(make_plane(1, 4)).overlap_fraction == 0);
}

TEST_CASE("the Jacobian maps a step on the surface to the step in UV", "[uv_atlas]") {
  const TriangleMesh blob = make_blob(2, 0.2, 24);
  const UvAtlas atlas(blob);
  for (uint32_t t = 0; t < blob.triangle_count(); ++t) {
    const Vec2 from(0.2, 0.3), to(0.5, 0.1);
    const Vec2 expected = blob.uv(t, to) - blob.uv(t, from);
    const Vec2 step = atlas.uv_from_surface(t, blob.position(t, to) - blob.position(t, from));
    CHECK(glm::length(step - expected) < 1e-5 * (1e-3 + glm::length(expected)));
    // Along the normal nothing changes.
    CHECK(glm::length(atlas.uv_from_surface(t, blob.geometric_normal(t))) < 1e-5);
  }
  const TriangleMesh plane = make_plane(4, 2);
  for (uint32_t t = 0; t < plane.triangle_count(); ++t) CHECK(UvAtlas(plane).uv_per_metre(t) == Approx(0.25));
}

TEST_CASE("missing, flat, tiled, mirrored and non-finite UVs", "[uv_atlas]") {
  TriangleMesh mesh = nasty::tetrahedron();
  CHECK(UvAtlas(mesh, 3).empty());
  CHECK(UvAtlas(TriangleMesh{}).empty());

  mesh.uv_sets[0].assign(4, Vec2f(0.5f));  // all in one point: one chart without area
  const UvAtlas flat(mesh);
  CHECK(flat.zero_area_triangles == 4);
  CHECK(flat.chart_count() == 1);
  CHECK(flat.uv_per_metre(0) == 0);
  CHECK(flat.uv_from_surface(0, Vec3(1)) == Vec2(0));
  CHECK(flat.overlap_fraction == 0);

  mesh.uv_sets[0] = {{0, 0}, {1, 0}, {0, 1}, {std::numeric_limits<float>::quiet_NaN(), 0}};
  const UvAtlas broken(mesh);
  CHECK(broken.non_finite_corners == 3);  // three triangles meet there
  for (uint32_t t = 0; t < 4; ++t) CHECK(std::isfinite(broken.uv_per_metre(t)));

  mesh.uv_sets[0] = {{0, 0}, {1e30f, 0}, {0, 1e30f}, {-1e30f, 1e30f}};
  const UvAtlas huge(mesh);
  CHECK(huge.out_of_range_corners == 9);
  CHECK(huge.overlap_fraction == 1);

  TriangleMesh tiled = make_plane(1, 8);
  for (Vec2f& uv : tiled.uv_sets[0]) uv = uv * 2.0f - 0.5f;
  const UvAtlas two_by_two(tiled);
  CHECK(two_by_two.overlap_fraction == 1);
  CHECK(two_by_two.chart_count() == 1);
  CHECK(two_by_two.out_of_range_corners > 0);

  TriangleMesh mirrored = make_plane(1, 8);  // u folded at the middle
  for (Vec2f& uv : mirrored.uv_sets[0]) uv.x = std::abs(uv.x - 0.5f);
  const UvAtlas folded(mirrored);
  CHECK(folded.overlap_fraction == 1);
  CHECK(folded.out_of_range_corners == 0);
}

TEST_CASE("every triangle can be a chart of its own", "[uv_atlas]") {
  TriangleMesh mesh = make_sphere(1, 12);
  const auto count = static_cast<uint32_t>(mesh.triangle_count());
  mesh.uv_sets[0].clear();
  const auto columns = static_cast<uint32_t>(std::ceil(std::sqrt(count)));
  for (uint32_t t = 0; t < count; ++t) {
    const Vec2f cell(static_cast<float>(t % columns), static_cast<float>(t / columns));
    const uint32_t base = 3 * t;
    mesh.attributes[t] = {base, base + 1, base + 2};
    for (const Vec2f corner : {Vec2f(0.1f, 0.1f), Vec2f(0.9f, 0.1f), Vec2f(0.1f, 0.9f)})
      mesh.uv_sets[0].push_back((cell + corner) / static_cast<float>(columns));
  }
  const UvAtlas atlas(mesh);
  CHECK(atlas.chart_count() == count);
  CHECK(atlas.overlap_fraction == 0);
  for (uint32_t t = 0; t < count; ++t) CHECK(atlas.chart(t) == t);
}

TEST_CASE("seams are where charts meet, and both sides name the same edge", "[uv_atlas]") {
  CHECK(find_uv_seams(make_plane(1, 4)).empty());
  CHECK(find_uv_seams(TriangleMesh{}).empty());
  const TriangleMesh blob = make_blob(1, 0.1, 24);  // six charts of 6 x 6 squares: twelve edges of a cube
  const std::vector<UvSeam> seams = find_uv_seams(blob);
  CHECK(seams.size() == 12 * 6);
  const UvAtlas atlas(blob);
  for (const UvSeam& seam : seams) {
    CHECK(atlas.chart(seam.triangle) != atlas.chart(seam.other_triangle));
    CHECK(seam.reversed);
    const Index3 &a = blob.corners[seam.triangle], &b = blob.corners[seam.other_triangle];
    CHECK(a[seam.side] == b[(seam.other_side + 1) % 3]);
    CHECK(a[(seam.side + 1) % 3] == b[seam.other_side]);
  }
}
