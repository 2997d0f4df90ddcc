#pragma once

#include <cstdint>

#include "optics/path_tally.h"
#include "optics/photon_walk.h"

namespace alabaster {

/// The half-space walk of half_space_tally for one random stream: photons in single-precision vector lanes, a
/// lane taking the next photon when its own has left. Only exactly rounded operations (+ - * / sqrt and
/// bits), so the tally is the same whatever the instruction set.
void walk_in_lanes(const WalkMedium& medium, uint64_t seed, uint64_t stream, uint64_t photons,
                   PathTally& tally);

}  // namespace alabaster
