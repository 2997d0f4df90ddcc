#include "optics/shape_families.h"

#include <algorithm>
#include <cmath>

#include "optics/light_aim.h"
#include "optics/row_position.h"
#include "optics/shape_lookup.h"

namespace alabaster {

using namespace shape_lookup;

namespace {

inline Float4 four(const Rgb& v, double last) {
  return Float4{static_cast<float>(v.r), static_cast<float>(v.g), static_cast<float>(v.b),
                static_cast<float>(last)};
}

inline Float4 remainder_of(const Rgb& albedo) {
  const Float4 remainder = four(Rgb(1) - albedo, 0), zero = remainder - remainder, one = zero + 1.f;
  const Float4 positive = remainder < zero ? zero : remainder;
  return positive < one ? positive : one;
}

}  // namespace

FreePaths::FreePaths(const Rgb& sigma_t)
    : path(four(Rgb(1) / sigma_t, 1)),
      log2_path(fast_log2(path)),
      longest(std::max({path[0], path[1], path[2]})),
      is_grey(sigma_t.is_grey()) {}

ShapeFamilies::ShapeFamilies(const ShapeTable& table) : g_(table.g), eta_(table.eta) {
  const AimSlopes slopes(eta_);
  for (const int16_t slope : table.aim)
    aim_.push_back(static_cast<float>(slopes.concentration(ShapeTable::step * slope)));
  table_.reserve(static_cast<std::size_t>(origin(ShapeGrid::family_count)));
  for (int f = 0; f < ShapeGrid::family_count; ++f) {
    const auto family = static_cast<ShapeFamily>(f);
    const int nodes = ShapeGrid::nodes(family);
    const auto baked = [&](int size, int node, int row) {
      size = std::clamp(size, 0, ShapeGrid::sizes - 1);
      return ShapeTable::step *
             table.log2_factor[static_cast<std::size_t>(f)][ShapeTable::index(family, size, node, row)];
    };
    table_.resize(table_.size() + static_cast<std::size_t>(nodes * rows));  // flat
    for (int s = 1; s < fine_sizes; ++s) {
      const int upper = ShapeGrid::sizes - 1 - (s - 1) / 2;
      for (int node = 0; node < nodes; ++node)
        for (int row = 0; row < rows; ++row) {
          const double at = baked(upper, node, row), next = baked(upper - 1, node, row);
          // Catmull-Rom's midpoint.
          const double value = s % 2 == 1 ? at
                                          : 0.5625 * (at + next) - 0.0625 * (baked(upper + 1, node, row) +
                                                                             baked(upper - 2, node, row));
          table_.push_back(static_cast<float>(value));
        }
    }
  }
}

Rgb ShapeFamilies::factor(const PairShape& pair, const Rgb& albedo, const FreePaths& paths) const {
  if (is_flat(pair, paths)) return Rgb(pair.reach);
  const Float4 lengths = fast_log2(Float4{at_least(pair.distance), at_least(std::abs(pair.curvature)),
                                          at_least(pair.inverse_thickness), 1});
  const Float4 remainder = remainder_of(albedo);
  const Query query{remainder,  fast_row_position(remainder),     lengths[0], lengths[1],
                    lengths[2], paths.is_grey && albedo.is_grey()};
  const Float4 factor = fast_exp2(log2_factor(table_.data(), static_cast<float>(g_), pair, paths, query));
  return pair.reach * Rgb(double{factor[0]}, double{factor[1]}, double{factor[2]});
}

Rgb ShapeFamilies::aim(const PairShape& pair, const Rgb& albedo, const Rgb& sigma_t) const {
  const Float4 path = four(Rgb(1) / sigma_t, 1);
  const Float4 curved = static_cast<float>(pair.bend) * path;
  const Float4 thin = static_cast<float>(pair.inverse_thickness) * path;
  const Float4 remainder = remainder_of(albedo);
  const Rows albedos(fast_row_position(remainder));
  const Float4 shape =
      square_root(curved * curved + thin * thin * thickness_fade(remainder, thin, static_cast<float>(g_)));
  const Float4 log2_rho = fast_log2(static_cast<float>(std::max(pair.distance, 1e-30)) / path);
  Rgb result;
  for (int c = 0; c < 3; ++c) {
    const float share = std::clamp((shape[c] - static_cast<float>(flat)) * 20, 0.f, 1.f);
    const float along =
        std::clamp(static_cast<float>(AimGrid::position(double{log2_rho[c]})), 0.f, AimGrid::nodes - 1.001f);
    const int node = static_cast<int>(along);
    const float* at = aim_.data() + AimGrid::index(node, albedos.row[c]);
    const float t = albedos.fraction[c], s = along - static_cast<float>(node);
    const float low = at[0] + t * (at[1] - at[0]), high = at[rows] + t * (at[rows + 1] - at[rows]);
    result[c] = double{share * share * (3 - 2 * share) * (low + s * (high - low))};
  }
  return result;
}

double ShapeFamilies::factor(ShapeFamily family, double size, double distance, double albedo) const {
  const bool is_slab = ShapeGrid::is_slab(family);
  const Float4 inverse = Float4{} + static_cast<float>(1 / size), log2_inverse = fast_log2(inverse);
  const Nodes nodes(Float4{} + static_cast<float>(std::log2(distance / (is_slab ? size : 2 * size))));
  const Rows albedos(fast_row_position(remainder_of(Rgb(albedo))));
  const float* table = table_.data() + origin(static_cast<int>(family));
  const Float4 log2_factor = is_slab ? one_family<slab_nodes>(table, nodes.node[1], nodes.along[1], inverse,
                                                              log2_inverse, albedos, true)
                                     : one_family<ball_nodes>(table, nodes.node[0], nodes.along[0], inverse,
                                                              log2_inverse, albedos, true);
  return double{fast_exp2(log2_factor)[0]};
}

}  // namespace alabaster
