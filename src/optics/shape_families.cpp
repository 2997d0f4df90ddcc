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

Rgb ShapeFamilies::aim(const PairShape& pair, const Rgb& albedo, const FreePaths& paths) const {
  const Float4 remainder = remainder_of(albedo);
  const Float4 share =
      aim_share(static_cast<float>(pair.bend) * paths.path,
                static_cast<float>(pair.inverse_thickness) * paths.path, remainder, static_cast<float>(g_));
  if (!(share[0] > 0 || share[1] > 0 || share[2] > 0)) return Rgb();
  const Rows albedos(fast_row_position(remainder));
  const Float4 along = aim_position(fast_log2(at_least(pair.distance) / paths.path));
  const Int4 node = to_integer(along), place = node * rows + albedos.row;
  const auto at = [&](int c) {
    const float* corner = aim_.data() + place[c];
    return load2(corner, corner + rows);
  };
  const Float4 slope = share * interpolate(at(0), at(1), at(2), albedos.fraction, along - to_float(node));
  return Rgb(double{slope[0]}, double{slope[1]}, double{slope[2]});
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

ShapeChannel::ShapeChannel(const ShapeFamilies& families, double albedo, double sigma_t)
    : families_(&families),
      path_(static_cast<float>(1 / sigma_t)),
      log2_path_(fast_log2(path_)),
      remainder_(std::clamp(static_cast<float>(1 - albedo), 0.f, 1.f)) {
  const float position = fast_row_position(remainder_) * (1.f / ShapeGrid::row_stride);
  row_ = std::min(static_cast<int32_t>(position), rows - 2);
  row_fraction_ = position - static_cast<float>(row_);
}

// The lanes are the families: ball or cavity, near side, far side.
double ShapeChannel::factor(const PairShape& pair) const {
  const auto slab = static_cast<float>(1 - pair.sphericity), far = static_cast<float>(pair.far);
  const float ball = 1 - far * slab;
  const auto curvature = static_cast<float>(std::abs(pair.curvature));
  const auto inverse_thickness = static_cast<float>(pair.inverse_thickness);
  const bool is_curved = ball > 0 && curvature * path_ > least;
  const bool is_thin = slab > 0 && inverse_thickness * path_ > least;
  if (!is_curved && !is_thin) return pair.reach;

  const bool is_far = is_thin && far > 0;  // otherwise the pair has no separation
  const float apart = is_far ? static_cast<float>(1 / pair.separation) : 1.f;
  const Float8 logs =
      fast_log2(Float8{std::max(curvature, least_length), std::max(inverse_thickness, least_length), apart, 1,
                       at_least(pair.distance), at_least(pair.lateral), 1, 1});
  const Float4 log2_inverse = lower(logs), log2_length = upper(logs);
  const Float4 log2_distance = __builtin_shufflevector(log2_length, log2_length, 0, 0, 1, 2);
  constexpr Float4 diameter{1, 0, 0, 0};
  const Nodes nodes(log2_inverse + log2_distance - diameter);
  const Sizes<Float4, Int4> sizes(Float4{curvature, inverse_thickness, apart, 0} * path_,
                                  log2_inverse + log2_path_);
  constexpr int b = ball_nodes * rows, s = slab_nodes * rows;
  constexpr int cavities = origin(static_cast<int>(ShapeFamily::cavity));
  constexpr Int4 stride{b, s, s, s};
  constexpr Int4 origins{0, origin(static_cast<int>(ShapeFamily::slab_near)),
                         origin(static_cast<int>(ShapeFamily::slab_far)), 0};
  const Int4 place = origins + sizes.level * stride + nodes.node * rows + row_;
  const float* table = families_->table();
  const float* balls = table + (pair.curvature > 0 ? 0 : cavities);
  Float4 cells[3]{};
  if (is_curved) cells[0] = corners<ball_nodes>(balls + place[0], nodes.along[0]);
  if (is_thin && far < 1) cells[1] = corners<slab_nodes>(table + place[1], nodes.along[1]);
  if (is_far) cells[2] = corners<slab_nodes>(table + place[2], nodes.along[2]);
  const Float4 found = interpolate(cells[0], cells[1], cells[2], Float4{} + row_fraction_, sizes.across);
  const float fade =
      thickness_fade(remainder_, inverse_thickness * path_, static_cast<float>(families_->g()));
  const float sum = ball * found[0] + slab * fade * ((1 - far) * found[1] + far * found[2]);
  return pair.reach * double{fast_exp2(sum)};
}

double ShapeChannel::aim(const PairShape& pair) const {
  const float share =
      aim_share(static_cast<float>(pair.bend) * path_, static_cast<float>(pair.inverse_thickness) * path_,
                remainder_, static_cast<float>(families_->g()));
  if (!(share > 0)) return 0;
  const float along = aim_position(fast_log2(at_least(pair.distance) / path_));
  const auto node = static_cast<int32_t>(along);
  const float* at = families_->aim_table() + node * rows + row_;
  const float low = at[0] + row_fraction_ * (at[1] - at[0]);
  const float high = at[rows] + row_fraction_ * (at[rows + 1] - at[rows]);
  return double{share * (low + (along - static_cast<float>(node)) * (high - low))};
}

}  // namespace alabaster
