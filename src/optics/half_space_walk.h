#pragma once

#include <cstdint>
#include <functional>

#include "optics/path_tally.h"
#include "optics/photon_walk.h"

namespace alabaster {

struct HalfSpaceWalkOptions {
  WalkMedium medium;
  uint64_t photons = 1000000;
  uint64_t seed = 1;
  bool normal_view = false;  // also score light leaving along the normal (vector lanes only)
};

/// Photons per independent random stream; photon counts are rounded up to whole chunks.
inline constexpr uint64_t photons_per_chunk = 1 << 16;

/// Walks photons of uniform incident radiance through a half-space and tallies where they leave, by
/// order. The scalar walk: an oracle for half_space_tally, several times slower.
PathTally half_space_tally_scalar(const HalfSpaceWalkOptions& options);

/// The same by vector lanes over photons. Both depend on photons and seed alone, not on the number of
/// threads. `progress`, when given, is called with the fraction done, from one thread at a time.
PathTally half_space_tally(const HalfSpaceWalkOptions& options,
                           const std::function<void(double)>& progress = {});

}  // namespace alabaster
