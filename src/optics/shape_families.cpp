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
constexpr double smallest_inverse = 1.0 / (1 << static_cast<int>(largest_log2));
constexpr int rows = ShapeGrid::rows;

// Positions among the sizes of inverse sizes per mean free path, given their logarithms too.
Float4 size_position(Float4 inverse, Float4 log2_inverse) {
  constexpr auto flat = static_cast<float>(ShapeFamilies::flat);
  const Float4 zero = inverse - inverse;
  const Float4 nearly_flat = (inverse - flat) * static_cast<float>(1 / (smallest_inverse - flat));
  const Float4 curved = 1.f + sizes_per_octave * (log2_inverse + static_cast<float>(largest_log2));
  const Float4 last = zero + static_cast<float>(fine_sizes - 1);
  const Float4 position = inverse < static_cast<float>(smallest_inverse) + zero ? nearly_flat : curved;
  const Float4 bounded = position < last ? position : last;
  return inverse <= flat + zero ? zero : bounded;
}

float node_position(ShapeFamily family, float log2_ratio) {
  const float position =
      (log2_ratio - static_cast<float>(ShapeGrid::first_octave(family))) * ShapeGrid::nodes_per_octave;
  return std::clamp(position, 0.f, static_cast<float>(ShapeGrid::nodes(family) - 1));
}

// 1 on slabs thinner than eight diffusion lengths, 0 beyond ten; `remainder` is 1 - albedo, `inverse` that of
// the optical thickness.
Float4 thickness_fade(Float4 remainder, Float4 inverse, float g) {
  // The squares of thickness / diffusion length against 64 and 100.
  const Float4 square = inverse * inverse, zero = square - square, one = zero + 1.f;
  const Float4 absorption = 3.f * remainder * ((1.f - g) + g * remainder);
  Float4 x = (100.f * square - absorption) / (36.f * square + 1e-30f);
  x = x < zero ? zero : x;
  x = x < one ? x : one;
  return x * x * (3.f - 2.f * x);
}

Float4 four(const Rgb& v, double last) {
  return Float4{static_cast<float>(v.r), static_cast<float>(v.g), static_cast<float>(v.b),
                static_cast<float>(last)};
}

}  // namespace

ShapeFamilies::ShapeFamilies(const ShapeTable& table) : g_(table.g), eta_(table.eta) {
  for (const int16_t slope : table.aim) aim_.push_back(static_cast<float>(ShapeTable::step * slope));
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

// Three albedos among the rows.
struct ShapeFamilies::Rows {
  Float4 remainder, fraction;
  Int4 row;

  explicit Rows(const Rgb& albedo) {
    remainder = four(Rgb(1) - albedo, 0);
    const Float4 zero = remainder - remainder, one = zero + 1.f;
    remainder = remainder < zero ? zero : remainder;
    remainder = remainder < one ? remainder : one;
    const Float4 position = fast_row_position(remainder) * (1.f / ShapeGrid::row_stride);
    row = to_integer(position);
    const Int4 last = row - row + (rows - 2);
    row = row < last ? row : last;
    fraction = position - to_float(row);
  }
};

// log2 factors of one family in the first channels, each at its own size and albedo.
Float4 ShapeFamilies::log2_factor(ShapeFamily family, const Rows& rows_of, Float4 size, float node,
                                  int channels) const {
  const int nodes = ShapeGrid::nodes(family);
  const int lower = std::min(static_cast<int>(node), nodes - 2);
  const float along = node - static_cast<float>(lower);
  Float4 result{};
  for (int c = 0; c < channels; ++c) {
    const int level = std::min(static_cast<int>(size[c]), fine_sizes - 2);
    const float across = size[c] - static_cast<float>(level), t = rows_of.fraction[c];
    const float* at = table(family).data() + (level * nodes + lower) * rows + rows_of.row[c];
    const auto edge = [t](const float* p) { return p[0] + t * (p[1] - p[0]); };
    const float* next = at + nodes * rows;
    const float low = edge(at) + along * (edge(at + rows) - edge(at));
    const float high = edge(next) + along * (edge(next + rows) - edge(next));
    result[c] = low + across * (high - low);
  }
  return result;
}

Rgb ShapeFamilies::factor(const PairShape& pair, const Rgb& albedo, const Rgb& sigma_t) const {
  // log C = (1 - far) (log ball + (1 - s) log near) + far (s log ball + (1 - s) log far)
  const auto slab = static_cast<float>(1 - pair.sphericity), far = static_cast<float>(pair.far);
  const float ball = 1 - far * slab;
  const double curvature = std::abs(pair.curvature);
  const Float4 path = four(Rgb(1) / sigma_t, 1);
  const Float4 curved = static_cast<float>(curvature) * path;
  const Float4 thin = static_cast<float>(pair.inverse_thickness) * path;
  constexpr auto least = static_cast<float>(flat);
  const bool is_curved = ball > 0 && (curved[0] > least || curved[1] > least || curved[2] > least);
  const bool is_thin = slab > 0 && (thin[0] > least || thin[1] > least || thin[2] > least);
  if (!is_curved && !is_thin) return Rgb(pair.reach);

  const Float4 lengths{static_cast<float>(std::max(curvature, 1e-30)),
                       static_cast<float>(std::max(pair.inverse_thickness, 1e-30)),
                       static_cast<float>(std::max(pair.distance, 1e-30)),
                       static_cast<float>(std::max(pair.lateral, 1e-30))};
  const Float4 log2_length = fast_log2(lengths), log2_path = fast_log2(path);
  const Rows rows_of(albedo);
  const int channels = albedo.is_grey() && sigma_t.is_grey() ? 1 : 3;
  Float4 sum{};
  if (is_curved) {
    const ShapeFamily family = pair.curvature > 0 ? ShapeFamily::ball : ShapeFamily::cavity;
    const Float4 size = size_position(curved, log2_path + log2_length[0]);
    sum += ball * log2_factor(family, rows_of, size,
                              node_position(family, log2_length[2] + log2_length[0] - 1), channels);
  }
  if (is_thin) {
    Float4 sides{};
    if (far < 1)
      sides += (1 - far) *
               log2_factor(ShapeFamily::slab_near, rows_of, size_position(thin, log2_path + log2_length[1]),
                           node_position(ShapeFamily::slab_near, log2_length[2] + log2_length[1]), channels);
    if (far > 0) {
      const Float4 across{static_cast<float>(1 / pair.separation), static_cast<float>(pair.lateral), 1, 1};
      const Float4 log2_across = fast_log2(across);
      sides +=
          far * log2_factor(ShapeFamily::slab_far, rows_of,
                            size_position(across[0] * path, log2_path + log2_across[0]),
                            node_position(ShapeFamily::slab_far, log2_across[1] + log2_across[0]), channels);
    }
    sum += slab * thickness_fade(rows_of.remainder, thin, static_cast<float>(g_)) * sides;
  }
  const Float4 factor = fast_exp2(sum);
  if (channels == 1) return Rgb(pair.reach * double{factor[0]});
  return pair.reach * Rgb(double{factor[0]}, double{factor[1]}, double{factor[2]});
}

Rgb ShapeFamilies::aim(const PairShape& pair, const Rgb& albedo, const Rgb& sigma_t) const {
  const Float4 path = four(Rgb(1) / sigma_t, 1);
  const Float4 curved = static_cast<float>(pair.bend) * path;
  const Float4 thin = static_cast<float>(pair.inverse_thickness) * path;
  const Rows rows_of(albedo);
  const Float4 shape = square_root(
      curved * curved + thin * thin * thickness_fade(rows_of.remainder, thin, static_cast<float>(g_)));
  const Float4 log2_rho = fast_log2(static_cast<float>(std::max(pair.distance, 1e-30)) / path);
  Rgb result;
  for (int c = 0; c < 3; ++c) {
    const float share = std::clamp((shape[c] - static_cast<float>(flat)) * 20, 0.f, 1.f);
    const float along =
        std::clamp(static_cast<float>(AimGrid::position(double{log2_rho[c]})), 0.f, AimGrid::nodes - 1.001f);
    const int node = static_cast<int>(along);
    const float* at = aim_.data() + AimGrid::index(node, rows_of.row[c]);
    const float t = rows_of.fraction[c], s = along - static_cast<float>(node);
    const float low = at[0] + t * (at[1] - at[0]), high = at[rows] + t * (at[rows + 1] - at[rows]);
    result[c] = double{share * share * (3 - 2 * share) * (low + s * (high - low))};
  }
  return result;
}

double ShapeFamilies::factor(ShapeFamily family, double size, double distance, double albedo) const {
  const double diameter = ShapeGrid::is_slab(family) ? size : 2 * size;
  const Float4 inverse = Float4{} + static_cast<float>(1 / size);
  const float node = node_position(family, static_cast<float>(std::log2(distance / diameter)));
  return double{fast_exp2(
      log2_factor(family, Rows(Rgb(albedo)), size_position(inverse, fast_log2(inverse)), node, 1))[0]};
}

}  // namespace alabaster
