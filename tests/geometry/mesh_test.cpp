#include "geometry/mesh.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "geometry/shapes.h"
#include "support/nasty_meshes.h"

using namespace alabaster;

TEST_CASE("a triangle's point, normal, area and UV", "[mesh]") {
  TriangleMesh mesh = nasty::from({{1, 2, 3}, {5, 2, 3}, {1, 5, 3}}, {{0, 1, 2}});
  CHECK(mesh.area(0) == 6);
  CHECK(mesh.geometric_normal(0) == Vec3(0, 0, 1));
  CHECK(mesh.position(0, {0.25, 0.5}) == Vec3(2, 3.5, 3));
  CHECK(mesh.uv(0, {0.25, 0.5}) == Vec2(2, 3.5));
  CHECK(mesh.uv(0, {0.25, 0.5}, 1) == Vec2(0));
  mesh.normals.assign(3, Vec3f(0, 0.6f, -0.8f));  // on the wrong side
  const SurfacePoint point = mesh.surface_point(0, {0.25, 0.5});
  CHECK(glm::length(point.shading_normal - Vec3(0, -0.6, 0.8)) < 1e-7);
  CHECK(point.uv == Vec2(2, 3.5));
  mesh.normals.clear();
  CHECK(mesh.surface_point(0, {0, 0}).shading_normal == Vec3(0, 0, 1));
}

TEST_CASE("area and volume come near the closed forms, wherever the mesh lies", "[mesh]") {
  TriangleMesh sphere = make_sphere(2, 128);
  const double volume = enclosed_volume(sphere);
  CHECK(surface_area(sphere) == Approx(16 * pi).epsilon(2e-3));
  CHECK(volume == Approx(32 * pi / 3).epsilon(2e-3));
  for (Vec3& p : sphere.positions) p += Vec3(1e6, 1e6, -1e6);
  CHECK(enclosed_volume(sphere) == Approx(volume).epsilon(1e-8));
  CHECK(bounding_box(sphere).diagonal() == Approx(4 * std::sqrt(3.0)).epsilon(1e-3));
  CHECK(bounding_box(TriangleMesh{}).empty());
}

TEST_CASE("tiny, huge and flat triangles have unit or zero normals", "[mesh]") {
  for (const double size : {1e-150, 1e-30, 1.0, 1e30, 1e150}) {
    const TriangleMesh mesh = nasty::from({{0, 0, 0}, {size, 0, 0}, {0, size, 0}}, {{0, 1, 2}});
    CHECK(glm::length(mesh.geometric_normal(0) - Vec3(0, 0, 1)) < 1e-14);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vec3 third : {Vec3(2, 0, 0), Vec3(0, 0, 0), Vec3(nan, 0, 0)}) {
    const TriangleMesh mesh = nasty::from({{0, 0, 0}, {1, 0, 0}, third}, {{0, 1, 2}});
    CHECK(mesh.geometric_normal(0) == Vec3(0));
  }
}

TEST_CASE("smooth normals of a sphere point outwards, over UV seams as well", "[mesh]") {
  TriangleMesh sphere = make_blob(1, 0, 48);
  const TriangleMesh original = sphere;
  compute_smooth_normals(sphere);
  for (std::size_t t = 0; t < sphere.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = sphere.positions[sphere.corners[t][k]];
      CHECK(glm::dot(Vec3(sphere.normals[sphere.attributes[t][k]]), glm::normalize(p)) > 0.999);
      CHECK(sphere.uv_sets[0][sphere.attributes[t][k]] == original.uv_sets[0][original.attributes[t][k]]);
    }
}

TEST_CASE("an attribute that positions share is split for their normals", "[mesh]") {
  TriangleMesh mesh = nasty::tetrahedron();
  mesh.normals.clear();
  mesh.uv_sets[0] = {Vec2f(0.25f, 0.5f)};  // one UV for all
  mesh.attributes.assign(4, {0, 0, 0});
  TriangleMesh flat = mesh;
  compute_smooth_normals(mesh);
  CHECK(mesh.normals.size() == 4);
  compute_flat_normals(flat);
  CHECK(flat.normals.size() == 4);
  for (uint32_t t = 0; t < 4; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(glm::length(Vec3(flat.normals[flat.attributes[t][k]]) - flat.geometric_normal(t)) < 1e-6);
      CHECK(flat.uv_sets[0][flat.attributes[t][k]] == Vec2f(0.25f, 0.5f));
    }
}

TEST_CASE("tangents follow u, the bitangent follows the image upwards, mirrored sides are told apart",
          "[mesh]") {
  // glTF: v runs down the image; bitangent = cross(normal, tangent) * w points up the image.
  TriangleMesh plane = make_plane(2, 2);
  compute_tangents(plane, 0);
  for (const Vec4f& tangent : plane.tangents) CHECK(tangent == Vec4f(1, 0, 0, 1));
  // Two triangles mirrored at x = 0 that share their attributes there.
  TriangleMesh mirror = nasty::from({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}, {{0, 1, 2}, {0, 2, 3}});
  mirror.uv_sets[0] = {{0, 1}, {1, 1}, {0, 0}, {1, 1}};
  compute_tangents(mirror, 0);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(mirror.tangents[mirror.attributes[0][k]] == Vec4f(1, 0, 0, 1));
    CHECK(mirror.tangents[mirror.attributes[1][k]] == Vec4f(-1, 0, 0, -1));
  }
  // No UVs, or none of any area: still unit and perpendicular.
  for (TriangleMesh mesh : {nasty::tetrahedron(), nasty::single_triangle()}) {
    mesh.uv_sets[0].assign(mesh.uv_sets[0].size(), Vec2f(0.5f));
    compute_tangents(mesh, 0);
    for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
      CHECK(glm::length(Vec3f(mesh.tangents[i])) == Approx(1));
      CHECK(std::abs(glm::dot(Vec3f(mesh.tangents[i]), mesh.normals[i])) < 1e-6f);
    }
  }
}
