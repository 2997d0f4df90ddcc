#include "optics/shape_families.h"

#include <algorithm>
#include <cmath>

#include "optics/row_position.h"

namespace alabaster {

namespace {

// Sizes at run time: 0 is flat, 1 the largest, then four to the octave down to the smallest.
constexpr int fine_sizes = 2 * (ShapeGrid::sizes - 1) + 2;
constexpr float sizes_per_octave = 4;
constexpr double largest_log2 = ShapeGrid::first_size_octave + 0.5 * (ShapeGrid::sizes - 1);
const double smallest_inverse = std::exp2(-largest_log2);
constexpr int rows = ShapeGrid::rows;

// Position among the sizes of an inverse size per mean free path.
double size_position(double inverse) {
  if (inverse <= ShapeFamilies::flat) return 0;
  if (inverse < smallest_inverse)
    return (inverse - ShapeFamilies::flat) / (smallest_inverse - ShapeFamilies::flat);
  const double position = 1 + sizes_per_octave * (std::log2(inverse) + largest_log2);
  return std::min(position, fine_sizes - 1.0);
}

double node_position(ShapeFamily family, double ratio) {
  const double position =
      (std::log2(std::max(ratio, 1e-30)) - ShapeGrid::first_octave(family)) * ShapeGrid::nodes_per_octave;
  return std::clamp(position, 0.0, ShapeGrid::nodes(family) - 1.0);
}

// 1 on slabs thinner than eight diffusion lengths, 0 beyond ten; per channel, inverse thickness in optical
// units.
Float4 thickness_fade(const Rgb& albedo, const Rgb& inverse, double g) {
  Float4 fade{};
  for (int c = 0; c < 3; ++c) {
    // (thickness / diffusion length)^2 against 64 and 100.
    const double inverse_square = 3 * (1 - albedo[c]) * (1 - g * albedo[c]), square = inverse[c] * inverse[c];
    const double x = std::clamp((100 * square - inverse_square) / (36 * square), 0.0, 1.0);
    fade[c] = static_cast<float>(x * x * (3 - 2 * x));
  }
  return fade;
}

}  // namespace

ShapeFamilies::ShapeFamilies(const ShapeTable& table) : g_(table.g), eta_(table.eta) {
  for (int f = 0; f < ShapeGrid::family_count; ++f) {
    const auto family = static_cast<ShapeFamily>(f);
    const int nodes = ShapeGrid::nodes(family);
    const auto baked = [&](int size, int node, int row) {
      size = std::clamp(size, 0, ShapeGrid::sizes - 1);
      return ShapeTable::step *
             table.log2_factor[static_cast<std::size_t>(f)][ShapeTable::index(family, size, node, row)];
    };
    std::vector<float>& fine = tables_[static_cast<std::size_t>(f)];
    fine.resize(static_cast<std::size_t>(fine_sizes * nodes * rows));
    for (int s = 1; s < fine_sizes; ++s) {
      const int upper = ShapeGrid::sizes - 1 - (s - 1) / 2;
      for (int node = 0; node < nodes; ++node)
        for (int row = 0; row < rows; ++row) {
          const double at = baked(upper, node, row), next = baked(upper - 1, node, row);
          // Catmull-Rom's midpoint.
          const double value = s % 2 == 1 ? at
                                          : 0.5625 * (at + next) - 0.0625 * (baked(upper + 1, node, row) +
                                                                             baked(upper - 2, node, row));
          fine[static_cast<std::size_t>((s * nodes + node) * rows + row)] = static_cast<float>(value);
        }
    }
  }
}

// One family's log2 factors in three channels.
struct ShapeFamilies::Lookup {
  Int4 row;
  Float4 row_fraction;

  explicit Lookup(const Rgb& albedo) {
    const auto remainder = [](double a) { return static_cast<float>(std::min(std::max(1 - a, 0.0), 1.0)); };
    const Float4 remainders{remainder(albedo.r), remainder(albedo.g), remainder(albedo.b), 0};
    const Float4 position = fast_row_position(remainders) * (1.f / ShapeGrid::row_stride);
    row = to_integer(position);
    const Int4 last = row - row + (rows - 2);
    row = row < last ? row : last;
    row_fraction = position - to_float(row);
  }

  Float4 operator()(const std::vector<float>& table, ShapeFamily family, const double size[3],
                    double node) const {
    const int nodes = ShapeGrid::nodes(family);
    const int n = std::min(static_cast<int>(node), nodes - 2);
    const auto along = static_cast<float>(node - n);
    Float4 result{};
    for (int c = 0; c < 3; ++c) {
      const int s = std::min(static_cast<int>(size[c]), fine_sizes - 2);
      const auto across = static_cast<float>(size[c] - s);
      const float t = row_fraction[c];
      const float* corner = &table[static_cast<std::size_t>((s * nodes + n) * rows + row[c])];
      const auto at = [&](const float* p) { return p[0] + t * (p[1] - p[0]); };
      const float* next = corner + nodes * rows;
      const float a = at(corner), b = at(corner + rows), d = at(next), e = at(next + rows);
      const float low = a + along * (b - a), high = d + along * (e - d);
      result[c] = low + across * (high - low);
    }
    return result;
  }
};

Rgb ShapeFamilies::factor(const PairShape& pair, const Rgb& albedo, const Rgb& sigma_t) const {
  const Lookup look_up(albedo);
  const auto positions = [&](double inverse, double(&position)[3]) {
    position[0] = size_position(inverse / sigma_t.r);
    const bool grey = sigma_t.is_grey();
    position[1] = grey ? position[0] : size_position(inverse / sigma_t.g);
    position[2] = grey ? position[0] : size_position(inverse / sigma_t.b);
    return position[0] > 0 || position[1] > 0 || position[2] > 0;
  };
  // log C = (1 - far) (log ball + (1 - s) log near) + far (s log ball + (1 - s) log far)
  const double slab = 1 - pair.sphericity, ball = 1 - pair.far * slab;
  Float4 log2_factor{};
  double size[3];
  const double curvature = std::abs(pair.curvature);
  if (ball > 0 && positions(curvature, size)) {
    const ShapeFamily family = pair.curvature > 0 ? ShapeFamily::ball : ShapeFamily::cavity;
    log2_factor += static_cast<float>(ball) * look_up(table(family), family, size,
                                                      node_position(family, 0.5 * pair.distance * curvature));
  }
  if (slab > 0 && positions(pair.inverse_thickness, size)) {
    Float4 thin{};
    const auto near_share = static_cast<float>(slab * (1 - pair.far)),
               far_share = static_cast<float>(slab * pair.far);
    if (near_share > 0) {
      const double node = node_position(ShapeFamily::slab_near, pair.distance * pair.inverse_thickness);
      thin += near_share * look_up(table(ShapeFamily::slab_near), ShapeFamily::slab_near, size, node);
    }
    if (far_share > 0) {
      const double node = node_position(ShapeFamily::slab_far, pair.lateral * pair.inverse_thickness);
      thin += far_share * look_up(table(ShapeFamily::slab_far), ShapeFamily::slab_far, size, node);
    }
    log2_factor += thin * thickness_fade(albedo, Rgb(pair.inverse_thickness) / sigma_t, g_);
  }
  const Float4 factor = fast_exp2(log2_factor);
  return {double{factor[0]}, double{factor[1]}, double{factor[2]}};
}

double ShapeFamilies::factor(ShapeFamily family, double size, double distance, double albedo) const {
  const bool slab = ShapeGrid::is_slab(family);
  const double position = size_position(1 / size);
  const double node = node_position(family, distance / (slab ? size : 2 * size));
  const double positions[3] = {position, position, position};
  return double{fast_exp2(Lookup(Rgb(albedo))(table(family), family, positions, node))[0]};
}

}  // namespace alabaster
