#include "geometry/still_life.h"

#include <algorithm>
#include <cmath>

#include "geometry/mesh_builder.h"

namespace alabaster {

namespace {

constexpr int petals = 9;

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// A uniform cubic B-spline through its first and last control point.
class Spline {
 public:
  explicit Spline(std::vector<Vec2> points) : points_(std::move(points)) {
    points_.insert(points_.begin(), 2, points_.front());
    points_.insert(points_.end(), 2, points_.back());
  }
  /// t in [0, 1].
  Vec2 at(double t) const {
    const double x = std::clamp(t, 0.0, 1.0) * static_cast<double>(points_.size() - 3);
    const std::size_t k = std::min(static_cast<std::size_t>(x), points_.size() - 4);
    const double f = x - static_cast<double>(k), g = 1 - f;
    return (g * g * g * points_[k] + (3 * f * f * f - 6 * f * f + 4) * points_[k + 1] +
            (3 * g * g * g - 6 * g * g + 4) * points_[k + 2] + f * f * f * points_[k + 3]) /
           6.0;
  }

 private:
  std::vector<Vec2> points_;
};

/// (radius, height) from the middle of the foot's underside over the rim to the middle of the bowl's bottom.
const Spline& bowl_profile() {
  // Foot from its hollow underside; wall outside; rim; wall inside, ever thicker.
  static const Spline profile(
      {{0.0, 0.004},     {0.018, 0.004},   {0.0285, 0.0035}, {0.0325, 0.0},    {0.040, 0.0},
       {0.0425, 0.004},  {0.037, 0.009},   {0.029, 0.013},   {0.026, 0.019},   {0.031, 0.0245},
       {0.044, 0.029},   {0.060, 0.036},   {0.074, 0.047},   {0.0835, 0.061},  {0.0885, 0.076},
       {0.0905, 0.090},  {0.0912, 0.1005}, {0.0914, 0.107},  {0.0909, 0.1086}, {0.0899, 0.1086},
       {0.0894, 0.107},  {0.0890, 0.1005}, {0.0880, 0.090},  {0.0857, 0.077},  {0.0803, 0.0630},
       {0.0705, 0.0500}, {0.056, 0.0410},  {0.038, 0.0370},  {0.018, 0.0360},  {0.0, 0.0360}});
  return profile;
}
constexpr double rim = 0.62;  // where the outer side of the profile ends

/// Place across a petal, -1 .. 1, 0 in its middle.
double across_petal(double turn, double offset) {
  const double x = turn * petals + offset;
  return 2 * (x - std::floor(x)) - 1;
}

/// 1 in the middle of a petal, 0 where two meet, where it has a sharp but smooth valley.
double lobe(double x) {
  return std::pow(0.5 + 0.5 * std::cos(pi * x), 0.7);
}

/// Height above the wall of the carved petals of the lower tier and of the ribs, m; outer side only.
double relief(double x_upper, double x_lower, double t, double height) {
  const double outer = 1 - smooth_step(rim - 0.10, rim - 0.02, t);
  // The lower petals: pillows within a pointed outline.
  const double rise = std::clamp((height - 0.024) / 0.062, 0.0, 1.0);
  const double half_width = 1.02 * (1 - std::pow(rise, 2.4));
  const double inside = smooth_step(-0.05, 0.42, half_width - std::sqrt(x_lower * x_lower + 0.0016));
  const double lower = 0.0034 * inside * smooth_step(0.024, 0.040, height);
  // Ribs that run up the free part of the upper petals.
  const double ribs = 0.00025 * std::cos(6 * pi * x_upper) * smooth_step(0.055, 0.085, height) *
                      (1 - 0.8 * inside) * (1 - std::abs(x_upper));
  return outer * (lower + ribs);
}

/// The surface: `turn` around the axis and t along the profile, both in [0, 1].
Vec3 bowl_point(double turn, const Vec3& outwards, double t) {
  const Vec2 p = bowl_profile().at(t);
  const double x = across_petal(turn, 0.5), petal = lobe(x);
  // The petals grow out of the base: 0 on the foot and on the axis.
  const double grow = smooth_step(0.030, 0.112, p.y) * smooth_step(0.03, 0.06, p.x);
  const double tip = std::exp(-std::sqrt(x * x + 0.0025) / 0.16);
  const double bend = grow * (0.006 * petal - 0.004) + grow * grow * grow * (0.010 * petal + 0.004 * tip);
  const double lift = grow * grow * (0.026 * petal - 0.016 + 0.008 * tip);
  const double carved = p.x > 0.02 ? relief(x, across_petal(turn, 0.0), t, p.y) : 0;
  return (p.x + bend + carved) * outwards + Vec3(0, p.y + lift, 0);
}

}  // namespace

TriangleMesh make_lotus_bowl(int columns, int rows) {
  // v by the length of the undeformed profile, so that texels have about one size along it.
  std::vector<double> length{0};
  for (int j = 1; j <= rows; ++j)
    length.push_back(length.back() + glm::length(bowl_profile().at(static_cast<double>(j) / rows) -
                                                 bowl_profile().at(static_cast<double>(j - 1) / rows)));

  const auto outwards = [&](double i) {
    const Vec2 c = circle_point(i, columns);
    return Vec3(-c.y, 0, -c.x);
  };
  const auto point = [&](double i, double j) {
    // The turn is taken modulo 1 so that both ends of the seam have the same bits.
    return bowl_point(std::fmod(i, columns) / columns, outwards(i), j / rows);
  };
  MeshBuilder builder;
  // From the underside upwards is upwards in the image too: rows run from the inner bottom to the foot.
  builder.add_patch(columns, rows, [&](double i, double j) -> MeshBuilder::Vertex {
    const double k = rows - j;
    constexpr double h = 1e-3;
    const Vec3 east = point(i + h, k) - point(i - h + columns, k);
    const Vec3 along = point(i, std::min(k + h, double(rows))) - point(i, std::max(k - h, 0.0));
    Vec3 normal = glm::cross(east, along);
    if (j == 0 || j == rows) normal = {0, j == 0 ? 1 : -1, 0};
    return {point(i, k), normal, {i / columns, 1 - length[static_cast<std::size_t>(k)] / length.back()}};
  });
  return std::move(builder).finish();
}

TriangleMesh make_backdrop(double width, double depth, double height, double bend_radius) {
  constexpr int bend_rows = 24;
  // (z, y) from the top of the wall downwards, then to the front.
  std::vector<Vec2> line{{-depth / 2, height}};
  std::vector<Vec2> normals{{1, 0}};
  for (int k = 0; k <= bend_rows; ++k) {
    const double a = pi / 2 * k / bend_rows;
    const Vec2 n{k == bend_rows ? 0 : std::cos(a), k == 0 ? 0 : std::sin(a)};
    line.push_back(Vec2(-depth / 2, 0) + bend_radius * (Vec2(1) - n));
    normals.push_back(n);
  }
  line.push_back({depth / 2, 0});
  normals.push_back({0, 1});

  MeshBuilder builder;
  const int rows = static_cast<int>(line.size()) - 1;
  builder.add_patch(1, rows, [&](double i, double j) -> MeshBuilder::Vertex {
    const auto k = static_cast<std::size_t>(j);
    return {{width * (i - 0.5), line[k].y, line[k].x}, {0, normals[k].y, normals[k].x}, {i, j / rows}};
  });
  return std::move(builder).finish();
}

TriangleMesh transformed(TriangleMesh mesh, const Mat3& linear, const Vec3& offset) {
  const Mat3 for_normals = glm::transpose(glm::inverse(linear));
  for (Vec3& p : mesh.positions) p = linear * p + offset;
  for (Vec3f& n : mesh.normals) n = Vec3f(glm::normalize(for_normals * Vec3(n)));
  for (Vec4f& t : mesh.tangents) {
    const Vec3 turned = glm::normalize(linear * Vec3(t));
    t = Vec4f(Vec3f(turned), t.w);
  }
  return mesh;
}

}  // namespace alabaster
