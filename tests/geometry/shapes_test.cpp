#include "geometry/shapes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <tuple>

#include "geometry/rectangle_packer.h"
#include "geometry/still_life.h"

using namespace alabaster;

namespace {

struct NamedShape {
  std::string name;
  TriangleMesh mesh;
  double volume = 0;  // of the exact shape; 0: not known
  double area = 0;
};

double ellipsoid_area(const Vec3& a, int n = 2000) {
  // Midpoint rule in the parameter domain, |dp/dtheta x dp/dphi|.
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double theta = pi * (i + 0.5) / n, st = std::sin(theta), ct = std::cos(theta);
    for (int j = 0; j < 256; ++j) {
      const double phi = 2 * pi * (j + 0.5) / 256;
      const Vec3 n_over_det{st * std::cos(phi) / a.x, ct / a.y, st * std::sin(phi) / a.z};
      sum += st * a.x * a.y * a.z * glm::length(n_over_det);
    }
  }
  return sum * (pi / n) * (2 * pi / 256);
}

std::vector<NamedShape> closed_shapes(int resolution) {
  const Vec3 axes{1, 2, 3};
  const double fold_middle = 2 * 1.0 + pi * 0.5 * (0.05 + 0.1);
  return {{"sphere", make_sphere(2, resolution), 4.0 / 3 * pi * 8, 4 * pi * 4},
          {"ellipsoid", make_ellipsoid(axes, resolution), 4.0 / 3 * pi * 6, ellipsoid_area(axes)},
          {"cavity", make_cavity(1, 1.5, resolution), 27 - 4.0 / 3 * pi, 6 * 9 + 4 * pi},
          {"cylinder", make_cylinder(0.5, 2, resolution), pi * 0.25 * 2, 2 * pi * 0.5 * 2 + 2 * pi * 0.25},
          {"torus", make_torus(3, 1, resolution), 2 * pi * pi * 3, 4 * pi * pi * 3},
          {"slab", make_slab(1, 0.1, resolution), 0.1, 2 + 4 * 0.1},
          {"blob", make_blob(1, 0.2, resolution), 0, 0},
          // Pappus: the middle line's length times the cross-section.
          {"fold", make_folded_sheet(1, 0.1, 0.05, resolution), fold_middle * 0.1,
           2 * fold_middle + 2 * 0.1 + 2 * fold_middle * 0.1}};
}

Vec3 corner(const TriangleMesh& mesh, std::size_t triangle, std::size_t k) {
  return mesh.positions[mesh.corners[triangle][k]];
}

}  // namespace

TEST_CASE("closed shapes have every edge once in each direction") {
  auto shapes = closed_shapes(48);
  shapes.push_back({"lotus bowl", make_lotus_bowl(72, 60), 0, 0});
  for (const NamedShape& shape : shapes) {
    INFO(shape.name);
    std::map<std::pair<uint32_t, uint32_t>, int> directed;
    for (const Index3& t : shape.mesh.corners)
      for (std::size_t k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
    for (const auto& [edge, count] : directed) {
      REQUIRE(count == 1);
      REQUIRE(directed.count({edge.second, edge.first}) == 1);
    }
    // Euler: all are spheres but the torus, and the cavity, which has two components.
    const long euler = static_cast<long>(shape.mesh.positions.size()) -
                       static_cast<long>(directed.size() / 2) +
                       static_cast<long>(shape.mesh.triangle_count());
    CHECK(euler == (shape.name == "torus" ? 0 : shape.name == "cavity" ? 4 : 2));
  }
}

TEST_CASE("every position of a shape stands once and is used") {
  for (const NamedShape& shape : closed_shapes(32)) {
    INFO(shape.name);
    const auto less = [](const Vec3& a, const Vec3& b) {
      return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    };
    std::map<Vec3, int, decltype(less)> seen(less);
    for (const Vec3& p : shape.mesh.positions) CHECK(++seen[p] == 1);
    std::vector<bool> used(shape.mesh.positions.size());
    for (const Index3& t : shape.mesh.corners)
      for (const uint32_t k : t) used[k] = true;
    CHECK(std::find(used.begin(), used.end(), false) == used.end());
  }
}

TEST_CASE("volume and area converge to the exact shape's with the square of the resolution") {
  const auto coarse = closed_shapes(32), fine = closed_shapes(64), finest = closed_shapes(128);
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    INFO(coarse[k].name);
    const auto check = [&](const std::function<double(const TriangleMesh&)>& measure, double exact) {
      const double a = measure(coarse[k].mesh), b = measure(fine[k].mesh), c = measure(finest[k].mesh);
      REQUIRE(c > 0);
      if (exact == 0) {  // blob: no closed form, but the differences shrink fourfold
        CHECK((b - a) / (c - b) == Approx(4).epsilon(0.15));
      } else if (std::abs(a - exact) > 1e-9 * exact) {
        CHECK((exact - a) / (exact - b) == Approx(4).epsilon(0.15));
        CHECK((4 * c - b) / 3 == Approx(exact).epsilon(2e-4));  // extrapolated
      }
    };
    check(enclosed_volume, coarse[k].volume);
    check(surface_area, coarse[k].area);
  }
}

TEST_CASE("triangles have area in space and in UV, UVs lie in the unit square and are not mirrored") {
  auto shapes = closed_shapes(48);
  shapes.push_back({"plane", make_plane(2, 7), 0, 4});
  for (const NamedShape& shape : shapes) {
    INFO(shape.name);
    const TriangleMesh& mesh = shape.mesh;
    const double mean_area = surface_area(mesh) / static_cast<double>(mesh.triangle_count());
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
      REQUIRE(mesh.area(static_cast<uint32_t>(t)) > 1e-4 * mean_area);
      std::array<Vec2, 3> uv;
      for (std::size_t k = 0; k < 3; ++k) {
        uv[k] = mesh.uv_sets[0][mesh.attributes[t][k]];
        REQUIRE(std::min(uv[k].x, uv[k].y) >= 0);
        REQUIRE(std::max(uv[k].x, uv[k].y) <= 1);
      }
      const Vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
      // Counter-clockwise from outside; v runs downwards, so the determinant in (u, v) is negative.
      REQUIRE(a.x * b.y - a.y * b.x < -1e-12);
    }
  }
}

TEST_CASE("charts of one scale are isometric up to that scale") {
  for (const auto& [name, mesh] : {std::pair<std::string, TriangleMesh>{"slab", make_slab(1, 0.1, 16)},
                                   {"cylinder", make_cylinder(0.5, 2, 64)}}) {
    INFO(name);
    double least = 1e30, greatest = 0;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const Vec2 step =
            Vec2(mesh.uv_sets[0][mesh.attributes[t][next]]) - Vec2(mesh.uv_sets[0][mesh.attributes[t][k]]);
        const double scale = glm::length(step) / glm::length(corner(mesh, t, next) - corner(mesh, t, k));
        least = std::min(least, scale), greatest = std::max(greatest, scale);
      }
    CHECK(greatest == Approx(least).epsilon(2e-3));  // arc against chord, and floats
  }
}

TEST_CASE("normals are those of the exact surface") {
  const auto for_each_corner = [](const TriangleMesh& mesh, const auto& body) {
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        body(corner(mesh, t, k), Vec3(mesh.normals[mesh.attributes[t][k]]), static_cast<uint32_t>(t));
  };
  for_each_corner(make_sphere(3, 32),
                  [](const Vec3& p, const Vec3& n, uint32_t) { REQUIRE(glm::length(n - p / 3.0) < 1e-6); });
  for_each_corner(make_ellipsoid({1, 2, 3}, 32), [](const Vec3& p, const Vec3& n, uint32_t) {
    REQUIRE(glm::length(n - glm::normalize(p / Vec3(1, 4, 9))) < 1e-6);
  });
  for_each_corner(make_torus(2, 0.5, 64), [](const Vec3& p, const Vec3& n, uint32_t) {
    const Vec3 ring = 2.0 * glm::normalize(Vec3(p.x, 0, p.z));
    REQUIRE(glm::length(p - ring - 0.5 * n) < 1e-6);
  });
  // Elsewhere: within the turn of one segment of the facet's own normal; exactly it on flat faces.
  for (const NamedShape& shape : closed_shapes(64)) {
    INFO(shape.name);
    const double least = shape.name == "slab" ? 1 - 1e-6 : std::cos(0.3);
    for_each_corner(shape.mesh, [&](const Vec3&, const Vec3& n, uint32_t t) {
      REQUIRE(glm::length(n) == Approx(1).epsilon(1e-6));
      REQUIRE(glm::dot(n, shape.mesh.geometric_normal(t)) > least);
    });
  }
}

TEST_CASE("the blob's normals are perpendicular to its surface") {
  // Along a smooth curve the tangential part of the normal vanishes; the trapezoid rule over an edge leaves a
  // remainder of second order in the edge's length. A wrong normal leaves one of order zero.
  double remainders[2];
  for (int level = 0; level < 2; ++level) {
    const TriangleMesh mesh = make_blob(1, 0.2, 64 << level);
    double sum = 0;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
      const Vec3 edge = corner(mesh, t, 1) - corner(mesh, t, 0);
      const Vec3f normals = mesh.normals[mesh.attributes[t][0]] + mesh.normals[mesh.attributes[t][1]];
      sum += std::abs(glm::dot(Vec3(normals), edge)) / glm::length(edge);
    }
    remainders[level] = sum / static_cast<double>(mesh.triangle_count());
  }
  CHECK(remainders[0] < 0.01);
  CHECK(remainders[0] / remainders[1] == Approx(4).epsilon(0.15));
}

TEST_CASE("shapes have the size they are asked for") {
  const auto size = [](const TriangleMesh& mesh) {
    const BoundingBox box = bounding_box(mesh);
    return box.high - box.low;
  };
  CHECK(glm::length(size(make_sphere(2, 32)) - Vec3(4)) < 1e-12);
  CHECK(glm::length(size(make_torus(2, 0.5, 64)) - Vec3(5, 1, 5)) < 1e-12);
  CHECK(glm::length(size(make_cylinder(0.5, 2, 64)) - Vec3(1, 2, 1)) < 1e-12);
  CHECK(glm::length(size(make_slab(3, 0.2)) - Vec3(3, 0.2, 3)) < 1e-12);
  // Two layers and the gap; the bend's outer radius is gap / 2 + thickness.
  CHECK(glm::length(size(make_folded_sheet(1, 0.1, 0.05)) - Vec3(1.125, 0.25, 1)) < 1e-12);
  const TriangleMesh plane = make_plane(2, 3);
  CHECK(plane.positions.front() == Vec3(-1, 1, 0));
  CHECK(plane.uv_sets[0].front() == Vec2f(0, 0));
  CHECK(plane.geometric_normal(0) == Vec3(0, 0, 1));
}

TEST_CASE(
    "the lotus bowl is thin at the rim and thick at the base, with normals that agree with its facets") {
  const TriangleMesh bowl = make_lotus_bowl();
  CHECK(enclosed_volume(bowl) > 0);
  const BoundingBox box = bounding_box(bowl);
  CHECK(box.low.y >= 0);
  CHECK(box.low.y < 0.001);
  CHECK(box.high.y > 0.1);
  double mean_thickness = 2 * enclosed_volume(bowl) / surface_area(bowl);
  CHECK(mean_thickness > 0.003);
  CHECK(mean_thickness < 0.01);
  for (uint32_t t = 0; t < bowl.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      REQUIRE(glm::dot(Vec3(bowl.normals[bowl.attributes[t][k]]), bowl.geometric_normal(t)) > 0.7);
}

TEST_CASE("a transformed mesh keeps its normals perpendicular") {
  const Mat3 linear(1, 0.2, 0, 0, 0.5, 0, 0.3, 0, 2);
  const TriangleMesh mesh = transformed(make_sphere(1, 64), linear, {1, 2, 3});
  CHECK(enclosed_volume(mesh) == Approx(enclosed_volume(make_sphere(1, 64)) * glm::determinant(linear)));
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      REQUIRE(glm::dot(Vec3(mesh.normals[mesh.attributes[t][k]]), mesh.geometric_normal(t)) > 0.95);
}

TEST_CASE("packed rectangles keep their gutters and do not overlap") {
  const std::vector<Vec2> sizes{{3, 1}, {1, 2}, {0.5, 0.5}, {2, 2}, {1, 0.1}};
  const double gutter = 0.02;
  const RectanglePacking packing = pack_rectangles(sizes, gutter);
  for (std::size_t a = 0; a < sizes.size(); ++a) {
    const Vec2 low = packing.origins[a], high = low + packing.scale * sizes[a];
    CHECK(std::min(low.x, low.y) >= gutter - 1e-12);
    CHECK(std::max(high.x, high.y) <= 1 - gutter + 1e-12);
    for (std::size_t b = 0; b < a; ++b) {
      const Vec2 other_low = packing.origins[b], other_high = other_low + packing.scale * sizes[b];
      const double apart =
          std::max({low.x - other_high.x, other_low.x - high.x, low.y - other_high.y, other_low.y - high.y});
      CHECK(apart >= gutter - 1e-12);
    }
  }
  CHECK(packing.scale > 0.2);  // the largest is 3 wide; a third would be the bound
}
