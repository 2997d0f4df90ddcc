#include "geometry/shapes.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "geometry/mesh_builder.h"
#include "geometry/rectangle_packer.h"

namespace alabaster {

namespace {

using Vertex = MeshBuilder::Vertex;

/// Direction of longitude 2 pi k / n, eastwards from -z.
Vec3 longitude(double k, int n) {
  const Vec2 c = circle_point(k, n);
  return {-c.y, 0, -c.x};
}

/// Direction on the unit sphere, `i` of `columns` steps around and `j` of `rows` from the north pole.
Vec3 sphere_direction(double i, int columns, double j, int rows) {
  const Vec2 c = circle_point(j, 2 * rows);  // exact at both poles
  return c.y * longitude(i, columns) + Vec3(0, c.x, 0);
}

int segments(double length, double longest, int resolution, int least = 1) {
  return std::max(least, static_cast<int>(std::lround(resolution * length / longest)));
}

std::vector<double> even_knots(double low, double high, int count) {
  std::vector<double> knots;
  for (int k = 0; k <= count; ++k) knots.push_back(k == count ? high : low + (high - low) * k / count);
  return knots;
}

/// Which way an axis-parallel face of a box lies, and how its image stands on it seen from outside.
struct BoxFace {
  int normal_axis, normal_sign, right_axis, right_sign, down_axis, down_sign;
};
constexpr std::array<BoxFace, 6> box_faces{{{1, +1, 0, +1, 2, +1},
                                            {1, -1, 0, +1, 2, -1},
                                            {2, +1, 0, +1, 1, -1},
                                            {2, -1, 0, -1, 1, -1},
                                            {0, +1, 2, -1, 1, -1},
                                            {0, -1, 2, +1, 1, -1}}};

/// A box cut at the knots of each axis, and a map that takes it to its place in space.
struct WarpedBox {
  std::array<std::vector<double>, 3> knots;  // ascending
  std::function<Vec3(const Vec3&)> position;
  std::function<Vec3(const Vec3& p, const Vec3& face_normal)> normal;

  double length(int axis) const {
    const auto& k = knots[static_cast<std::size_t>(axis)];
    return k.back() - k.front();
  }
  Vec2 face_size(const BoxFace& face) const { return {length(face.right_axis), length(face.down_axis)}; }
};

/// One face as a patch; its chart is the flat face, scaled.
void add_box_face(MeshBuilder& builder, const WarpedBox& box, const BoxFace& face, Vec2 uv_origin,
                  double uv_scale) {
  const auto knot = [&](int axis, int sign, double k) {
    const auto& knots = box.knots[static_cast<std::size_t>(axis)];
    const auto index = static_cast<std::size_t>(k);
    return sign > 0 ? knots[index] : knots[knots.size() - 1 - index];
  };
  const auto count = [&](int axis) {
    return static_cast<int>(box.knots[static_cast<std::size_t>(axis)].size()) - 1;
  };
  const auto vertex = [&](double i, double j) -> Vertex {
    Vec3 p, n(0);
    p[face.right_axis] = knot(face.right_axis, face.right_sign, i);
    p[face.down_axis] = knot(face.down_axis, face.down_sign, j);
    p[face.normal_axis] = knot(face.normal_axis, -face.normal_sign, 0);
    n[face.normal_axis] = face.normal_sign;
    const Vec2 from_corner{std::abs(p[face.right_axis] - knot(face.right_axis, face.right_sign, 0)),
                           std::abs(p[face.down_axis] - knot(face.down_axis, face.down_sign, 0))};
    return {box.position(p), box.normal(p, n), uv_origin + uv_scale * from_corner};
  };
  builder.add_patch(count(face.right_axis), count(face.down_axis), vertex);
}

WarpedBox plain_box(const Vec3& size, int resolution) {
  const double longest = std::max({size.x, size.y, size.z});
  const auto knots = [&](double side) {
    return even_knots(-side / 2, side / 2, segments(side, longest, resolution));
  };
  return {{knots(size.x), knots(size.y), knots(size.z)},
          [](const Vec3& p) { return p; },
          [](const Vec3&, const Vec3& n) { return n; }};
}

TriangleMesh make_box(const WarpedBox& box) {
  std::vector<Vec2> sizes;
  for (const BoxFace& face : box_faces) sizes.push_back(box.face_size(face));
  const RectanglePacking packing = pack_rectangles(sizes, shape_gutter);
  MeshBuilder builder;
  for (std::size_t k = 0; k < box_faces.size(); ++k)
    add_box_face(builder, box, box_faces[k], packing.origins[k], packing.scale);
  return std::move(builder).finish();
}

/// Height of the blob's bumps over the unit sphere, within [-1, 1], and its gradient in space.
struct Bumps {
  double height = 0;
  Vec3 gradient{0};
};
Bumps bumps_at(const Vec3& d) {
  struct Wave {
    Vec3 frequency;
    double phase, weight;
  };
  static const std::array<Wave, 4> waves{{{{3.1, 1.2, -0.7}, 0.4, 0.35},
                                          {{-1.3, 3.7, 1.9}, 1.7, 0.30},
                                          {{1.1, -2.3, 4.3}, 2.9, 0.20},
                                          {{5.3, 2.9, 3.1}, 0.8, 0.15}}};
  Bumps result;
  for (const Wave& wave : waves) {
    const double argument = glm::dot(wave.frequency, d) + wave.phase;
    result.height += wave.weight * std::sin(argument);
    result.gradient += wave.weight * std::cos(argument) * wave.frequency;
  }
  return result;
}

}  // namespace

TriangleMesh make_plane(double size, int resolution) {
  MeshBuilder builder;
  builder.add_patch(resolution, resolution, [&](double i, double j) -> Vertex {
    const Vec2 uv = Vec2(i, j) / static_cast<double>(resolution);
    return {{size * (uv.x - 0.5), size * (0.5 - uv.y), 0}, {0, 0, 1}, uv};
  });
  return std::move(builder).finish();
}

TriangleMesh make_ellipsoid(const Vec3& semi_axes, int resolution) {
  const int rows = std::max(2, resolution / 2);
  MeshBuilder builder;
  builder.add_patch(resolution, rows, [&](double i, double j) -> Vertex {
    const Vec3 d = sphere_direction(i, resolution, j, rows);
    return {semi_axes * d, d / semi_axes, {i / resolution, j / rows}};
  });
  return std::move(builder).finish();
}

TriangleMesh make_sphere(double radius, int resolution) {
  return make_ellipsoid(Vec3(radius), resolution);
}

TriangleMesh make_cavity(double radius, double box_half_size, int resolution) {
  assert(radius < box_half_size);
  const WarpedBox box = plain_box(Vec3(2 * box_half_size), std::max(1, resolution / 16));
  std::vector<Vec2> sizes{{2 * pi * radius, pi * radius}};
  for (const BoxFace& face : box_faces) sizes.push_back(box.face_size(face));
  const RectanglePacking packing = pack_rectangles(sizes, shape_gutter);

  MeshBuilder builder;
  const int rows = std::max(2, resolution / 2);
  // Seen from inside the ball east lies to the left, so the columns run westwards.
  builder.add_patch(resolution, rows, [&](double i, double j) -> Vertex {
    const Vec3 d = sphere_direction(resolution - i, resolution, j, rows);
    const Vec2 flat = sizes[0] * Vec2(i / resolution, j / rows);
    return {radius * d, -d, packing.origins[0] + packing.scale * flat};
  });
  for (std::size_t k = 0; k < box_faces.size(); ++k)
    add_box_face(builder, box, box_faces[k], packing.origins[k + 1], packing.scale);
  return std::move(builder).finish();
}

TriangleMesh make_cylinder(double radius, double length, int resolution) {
  const double around = 2 * pi * radius;
  const std::vector<Vec2> sizes{{around, length}, Vec2(2 * radius), Vec2(2 * radius)};
  const RectanglePacking packing = pack_rectangles(sizes, shape_gutter);

  MeshBuilder builder;
  const int rows = segments(length, around, resolution);
  const auto height = [&](double j) { return j == rows ? -length / 2 : length / 2 - length * j / rows; };
  builder.add_patch(resolution, rows, [&](double i, double j) -> Vertex {
    const Vec3 d = longitude(i, resolution);
    const Vec2 flat = sizes[0] * Vec2(i / resolution, j / rows);
    return {radius * d + Vec3(0, height(j), 0), d, packing.origins[0] + packing.scale * flat};
  });
  const int rings = segments(radius, around, resolution);
  for (const int side : {+1, -1}) {
    const Vec2 centre = packing.origins[side > 0 ? 1 : 2] + packing.scale * Vec2(radius);
    builder.add_patch(resolution, rings, [&, side](double i, double j) -> Vertex {
      const Vec3 d = radius * (j / rings) * longitude(side > 0 ? i : resolution - i, resolution);
      return {
          d + Vec3(0, side * length / 2, 0), {0, side, 0}, centre + packing.scale * Vec2(d.x, side * d.z)};
    });
  }
  return std::move(builder).finish();
}

TriangleMesh make_torus(double ring_radius, double tube_radius, int resolution) {
  assert(tube_radius < ring_radius);
  // A multiple of four, so that the tube's outermost and topmost circles are on the mesh.
  const int rows = 4 * segments(tube_radius / 4, ring_radius + tube_radius, resolution);
  MeshBuilder builder;
  builder.add_patch(resolution, rows, [&](double i, double j) -> Vertex {
    const Vec3 outwards = longitude(i, resolution);
    const Vec2 c = circle_point(j, rows);
    // v starts at the innermost line, goes over the top to the outer side: downwards seen from outside.
    const Vec3 n = -c.x * outwards + Vec3(0, c.y, 0);
    return {ring_radius * outwards + tube_radius * n, n, {i / resolution, j / rows}};
  });
  return std::move(builder).finish();
}

TriangleMesh make_blob(double radius, double bump, int resolution) {
  assert(bump >= 0 && bump <= 0.5);
  // Equal angles rather than equal lengths on the cube's faces: the charts stretch less.
  const auto direction = [](const Vec3& p) {
    return glm::normalize(Vec3(std::tan(pi / 4 * p.x), std::tan(pi / 4 * p.y), std::tan(pi / 4 * p.z)));
  };
  const auto knots = even_knots(-1, 1, std::max(1, resolution / 4));
  return make_box({{knots, knots, knots},
                   [&](const Vec3& p) {
                     const Vec3 d = direction(p);
                     return radius * (1 + bump * bumps_at(d).height) * d;
                   },
                   [&](const Vec3& p, const Vec3&) {
                     // Gradient of |x| - r(x / |x|), times |x|.
                     const Vec3 d = direction(p);
                     const Bumps bumps = bumps_at(d);
                     const Vec3 along = bumps.gradient - glm::dot(bumps.gradient, d) * d;
                     return (1 + bump * bumps.height) * d - bump * along;
                   }});
}

TriangleMesh make_slab(double width, double thickness, int resolution) {
  return make_box(plain_box({width, thickness, width}, resolution));
}

TriangleMesh make_folded_sheet(double width, double thickness, double gap, int resolution) {
  const double bend_radius = (gap + thickness) / 2;  // of the sheet's middle
  const double bend_length = pi * bend_radius;
  // x of the flat sheet: lower layer, then the bend around 0, then the upper layer.
  std::vector<double> along = even_knots(-width - bend_length / 2, -bend_length / 2, resolution);
  for (const double x : even_knots(-bend_length / 2, bend_length / 2, std::max(16, resolution / 2)))
    if (x > along.back()) along.push_back(x);
  for (const double x : even_knots(bend_length / 2, bend_length / 2 + width, resolution))
    if (x > along.back()) along.push_back(x);

  // Angle of the bend at x, from 0 (the layer below) to pi (the layer above).
  const auto angle = [=](double x) { return pi * std::clamp(x / bend_length + 0.5, 0.0, 1.0); };
  const auto rotate = [=](double x, const Vec3& v) {
    const double a = angle(x),
                 c = x <= -bend_length / 2  ? 1
                     : x >= bend_length / 2 ? -1
                                            : std::cos(a),
                 s = std::abs(c) == 1 ? 0 : std::sin(a);
    return Vec3(-c * v.x - s * v.y, s * v.x - c * v.y, v.z);
  };
  return make_box({{along, even_knots(-thickness / 2, thickness / 2, segments(thickness, width, resolution)),
                    even_knots(-width / 2, width / 2, resolution)},
                   [=](const Vec3& p) {
                     const double straight = p.x < 0 ? std::min(p.x + bend_length / 2, 0.0)
                                                     : std::max(p.x - bend_length / 2, 0.0);
                     return rotate(p.x, {straight, p.y + bend_radius, 0}) + Vec3(0, 0, p.z);
                   },
                   [=](const Vec3& p, const Vec3& n) { return rotate(p.x, n); }});
}

}  // namespace alabaster
