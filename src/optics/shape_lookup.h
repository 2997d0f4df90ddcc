#pragma once

#include <algorithm>
#include <cmath>

#include "optics/shape_families.h"

// How ShapeFamilies reads its table: inline, for those who look up something else of the same pair as well.

namespace alabaster::shape_lookup {

// Sizes at run time: 0 is flat, 1 the largest, then four to the octave down to the smallest.
inline constexpr int fine_sizes = 2 * (ShapeGrid::sizes - 1) + 2;
inline constexpr float sizes_per_octave = 4;
inline constexpr double largest_log2 = ShapeGrid::first_size_octave + 0.5 * (ShapeGrid::sizes - 1);
inline constexpr double smallest_inverse = 1.0 / (1 << static_cast<int>(largest_log2));
inline constexpr int rows = ShapeGrid::rows;
inline constexpr auto least = static_cast<float>(ShapeFamilies::flat);

inline constexpr int ball_nodes = ShapeGrid::nodes(ShapeFamily::ball);
inline constexpr int slab_nodes = ShapeGrid::nodes(ShapeFamily::slab_near);
static_assert(ball_nodes == ShapeGrid::nodes(ShapeFamily::cavity));
static_assert(slab_nodes == ShapeGrid::nodes(ShapeFamily::slab_far));

// Stands for lengths of 0 where logarithms are taken.
inline constexpr float least_length = 1e-30f;
inline float at_least(double length) {
  return std::max(static_cast<float>(length), least_length);
}

// Albedos in three channels and lengths of a pair, with what others may know already.
struct Query {
  Float4 remainder;                                             // 1 - albedo, in [0, 1]
  Float4 row_position;                                          // of the albedo among AlbedoRows
  float log2_distance, log2_curvature, log2_inverse_thickness;  // of at_least() of what the pair says
  bool is_grey;                                                 // one albedo and one free path
};

// Where the table of a family begins.
constexpr int origin(int family) {
  int at = 0;
  for (int f = 0; f < family; ++f) at += fine_sizes * ShapeGrid::nodes(static_cast<ShapeFamily>(f)) * rows;
  return at;
}

// Three albedos among the rows.
struct Rows {
  Float4 fraction;
  Int4 row;

  explicit Rows(Float4 row_position) {
    const Float4 position = row_position * (1.f / ShapeGrid::row_stride);
    row = to_integer(position);
    const Int4 last = row - row + (rows - 2);
    row = row < last ? row : last;
    fraction = position - to_float(row);
  }
};

// Distances in units of the size among the nodes: of balls or cavities, near and far sides.
struct Nodes {
  Float4 along;  // from the node
  Int4 node;

  explicit Nodes(Float4 log2_ratio) {
    constexpr auto ball = static_cast<float>(ShapeGrid::first_octave(ShapeFamily::ball));
    constexpr auto slab = static_cast<float>(ShapeGrid::first_octave(ShapeFamily::slab_near));
    constexpr float ball_end = ball_nodes - 1, slab_end = slab_nodes - 1;
    constexpr Float4 zero{}, first{ball, slab, slab, slab}, end{ball_end, slab_end, slab_end, slab_end};
    constexpr Int4 last{ball_nodes - 2, slab_nodes - 2, slab_nodes - 2, slab_nodes - 2};
    Float4 position = (log2_ratio - first) * float{ShapeGrid::nodes_per_octave};
    position = position > zero ? position : zero;
    position = position < end ? position : end;
    node = to_integer(position);
    node = node < last ? node : last;
    along = position - to_float(node);
  }
};

// Inverse sizes per mean free path and their logarithms among the sizes: four of one family, or twice four.
template <typename Float, typename Int>
struct Sizes {
  Float across;  // from the lower size
  Int level;

  Sizes(Float inverse, Float log2_inverse) {
    const Float zero = inverse - inverse, end = zero + static_cast<float>(fine_sizes - 1);
    const Float nearly_flat =
        (inverse - least) * static_cast<float>(1 / (smallest_inverse - ShapeFamilies::flat));
    const Float curved = 1.f + sizes_per_octave * (log2_inverse + static_cast<float>(largest_log2));
    Float position = inverse < static_cast<float>(smallest_inverse) + zero ? nearly_flat : curved;
    position = position > zero ? position : zero;  // exactly 0 on flat
    position = position < end ? position : end;
    level = to_integer(position);
    const Int last = level - level + (fine_sizes - 2);
    level = level < last ? level : last;
    across = position - to_float(level);
  }
};

// Linear among rows and sizes in three lanes, from what stands at the corners: lower size, lower and upper
// row, then the upper size's.
template <typename Float>
inline Float interpolate(Float first, Float second, Float third, Float aside, Float across) {
  Float corners[4];
  columns(first, second, third, corners);
  const Float low = corners[0] + aside * (corners[1] - corners[0]);
  const Float high = corners[2] + aside * (corners[3] - corners[2]);
  return low + across * (high - low);
}

// The four corners among sizes and rows, between two nodes; `at` is the first corner at the lower node.
template <int nodes>
inline Float4 corners(const float* at, float along) {
  constexpr int next_size = nodes * rows;
  const Float4 low = load2(at, at + next_size);
  return low + along * (load2(at + rows, at + rows + next_size) - low);
}

// log2 factors of one family in three channels. Where `grey`, all are the first.
template <int nodes>
inline Float4 one_family(const float* family, int32_t node, float along, Float4 inverse, Float4 log2_inverse,
                         const Rows& albedos, bool grey) {
  const Sizes<Float4, Int4> sizes(inverse, log2_inverse);
  const float* table = family + node * rows;
  const Int4 place = sizes.level * (nodes * rows) + albedos.row;
  const auto at = [&](int c) { return corners<nodes>(table + static_cast<uint32_t>(place[c]), along); };
  const Float4 first = at(0);
  return grey ? interpolate(first, first, first, albedos.fraction, sizes.across)
              : interpolate(first, at(1), at(2), albedos.fraction, sizes.across);
}

// The same of a ball or cavity, and a side of a slab, at once.
inline Float8 two_families(const float* ball, const float* slab, const Int4& nodes, const Float4& along,
                           int side, Float8 inverse, Float8 log2_inverse, const Rows& albedos, bool grey) {
  const Sizes<Float8, Int8> sizes(inverse, log2_inverse);
  constexpr int b = ball_nodes * rows, s = slab_nodes * rows;
  constexpr Int8 stride{b, b, b, b, s, s, s, s};
  const Int8 place = sizes.level * stride + join(albedos.row, albedos.row);
  const float *ball_table = ball + nodes[0] * rows, *slab_table = slab + nodes[side] * rows;
  const Float8 fraction = join(albedos.fraction, albedos.fraction);
  const auto at = [&](int c) {
    return join(corners<ball_nodes>(ball_table + static_cast<uint32_t>(place[c]), along[0]),
                corners<slab_nodes>(slab_table + static_cast<uint32_t>(place[4 + c]), along[side]));
  };
  const Float8 first = at(0);
  return grey ? interpolate(first, first, first, fraction, sizes.across)
              : interpolate(first, at(1), at(2), fraction, sizes.across);
}

// 1 on slabs thinner than eight diffusion lengths, 0 beyond ten; `remainder` is 1 - albedo, `inverse` that of
// the optical thickness.
template <typename Float>
inline Float thickness_fade(Float remainder, Float inverse, float g) {
  // The squares of thickness / diffusion length against 64 and 100.
  const Float square = inverse * inverse, zero = square - square, one = zero + 1.f;
  const Float absorption = 3.f * remainder * ((1.f - g) + g * remainder);
  Float x = (100.f * square - absorption) / (36.f * square + 1e-30f);
  x = x < zero ? zero : x;
  x = x < one ? x : one;
  return x * x * (3.f - 2.f * x);
}

// How far light's aim has set in: on half-spaces not at all, in full above 1/20 per mean free path.
template <typename Float>
inline Float aim_share(Float curved, Float thin, Float remainder, float g) {
  const Float shape = square_root(curved * curved + thin * thin * thickness_fade(remainder, thin, g));
  Float x = (shape - least) * 20.f;
  const Float zero = x - x, one = zero + 1.f;
  x = x > zero ? x : zero;
  x = x < one ? x : one;
  return x * x * (3.f - 2.f * x);
}

// Places among the distances of AimGrid.
template <typename Float>
inline Float aim_position(Float log2_rho) {
  const Float x = 2.f * (log2_rho - static_cast<float>(AimGrid::first_octave)), zero = x - x;
  const Float end = zero + (AimGrid::nodes - 1.001f), positive = x > zero ? x : zero;
  return positive < end ? positive : end;
}

// log2 of ShapeFamilies::factor() over the pair's reach; the last lane is of no use.
// log C = (1 - far) (log ball + (1 - s) log near) + far (s log ball + (1 - s) log far)
[[gnu::always_inline]] inline Float4 log2_factor(const float* table, float g, const PairShape& pair,
                                                 const FreePaths& paths, const Query& query) {
  const auto slab = static_cast<float>(1 - pair.sphericity), far = static_cast<float>(pair.far);
  const auto curvature = static_cast<float>(std::abs(pair.curvature));
  const auto inverse_thickness = static_cast<float>(pair.inverse_thickness);
  const float ball = 1 - far * slab;
  const bool is_curved = ball > 0 && curvature * paths.longest > least;
  const bool is_thin = slab > 0 && inverse_thickness * paths.longest > least;
  const Rows albedos(query.row_position);
  const float* balls = table + (pair.curvature > 0 ? 0 : origin(static_cast<int>(ShapeFamily::cavity)));
  const Float4 curved = curvature * paths.path, log2_curved = paths.log2_path + query.log2_curvature;
  Float4 log2_ratio{query.log2_distance + query.log2_curvature - 1,
                    query.log2_distance + query.log2_inverse_thickness, 0, 0};
  if (!is_thin) {
    if (!is_curved) return Float4{};
    const Nodes nodes(log2_ratio);
    return ball * one_family<ball_nodes>(balls, nodes.node[0], nodes.along[0], curved, log2_curved, albedos,
                                         query.is_grey);
  }

  const float* near_side = table + origin(static_cast<int>(ShapeFamily::slab_near));
  const float* far_side = table + origin(static_cast<int>(ShapeFamily::slab_far));
  const Float4 thin = inverse_thickness * paths.path;
  const Float4 log2_thin = paths.log2_path + query.log2_inverse_thickness;
  Float4 apart = thin, log2_apart = log2_thin;
  if (far > 0) {
    const auto inverse = static_cast<float>(1 / pair.separation);
    const Float4 logs = fast_log2(Float4{inverse, at_least(pair.lateral), 1, 1});
    apart = inverse * paths.path;
    log2_apart = paths.log2_path + logs[0];
    log2_ratio[2] = logs[0] + logs[1];
  }
  const Nodes nodes(log2_ratio);
  const auto side_alone = [&](const float* side, int which, Float4 inverse, Float4 log2_inverse) {
    return one_family<slab_nodes>(side, nodes.node[which], nodes.along[which], inverse, log2_inverse, albedos,
                                  query.is_grey);
  };
  const bool is_near = far < 1;  // otherwise the far side alone is asked
  Float4 ball_part{}, sides;
  if (is_curved) {
    const Float8 both = is_near
                            ? two_families(balls, near_side, nodes.node, nodes.along, 1, join(curved, thin),
                                           join(log2_curved, log2_thin), albedos, query.is_grey)
                            : two_families(balls, far_side, nodes.node, nodes.along, 2, join(curved, apart),
                                           join(log2_curved, log2_apart), albedos, query.is_grey);
    ball_part = ball * lower(both);
    sides = upper(both);
  } else {
    sides = is_near ? side_alone(near_side, 1, thin, log2_thin) : side_alone(far_side, 2, apart, log2_apart);
  }
  if (is_near && far > 0) sides = (1 - far) * sides + far * side_alone(far_side, 2, apart, log2_apart);
  return ball_part + slab * thickness_fade(query.remainder, thin, g) * sides;
}

}  // namespace alabaster::shape_lookup
