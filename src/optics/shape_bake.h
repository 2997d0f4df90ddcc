#pragma once

#include <functional>
#include <vector>

#include "optics/profile_table.h"
#include "optics/shape_table.h"

namespace alabaster {

struct ShapeBakeOptions {
  WalkMedium medium;
  /// Per body, followed beyond 15 collisions; of cavities and of what is larger than four mean free paths
  /// eight times as many are up to there.
  uint64_t photons = 125'000;
  uint64_t seed = 1;
};

/// Photons per body of the named qualities of `alabaster bake`.
inline constexpr uint64_t quick_shape_photons = 125'000, full_shape_photons = 1'000'000;

/// Simulates balls, cavities and slabs and tabulates their profiles over those of `half_space`, which must be
/// of the same medium. `progress` gets the fraction done, from this thread.
ShapeTable bake_shapes(const ShapeBakeOptions& options, const ProfileTable& half_space,
                       const std::function<void(double)>& progress = {});

/// log2 of the factors of one body at one albedo over the half-space, at the nodes of the grid: penalised
/// least squares over log distance. `energy` is that of the radial bins over the albedo; `before` the factors
/// of the albedo next above, which hold where this one's are not measured (empty: none).
std::vector<double> shape_factors(ShapeFamily family, double size, double albedo,
                                  const std::vector<Estimate>& energy, const ProfileTable& half_space,
                                  const std::vector<double>& before);

/// How a body of that family is walked: which of its photons are followed how far.
WalkBody shape_body(ShapeFamily family, double size);
BodyWalkOptions shape_walk_options(ShapeFamily family, double size, const ShapeBakeOptions& options);

}  // namespace alabaster
