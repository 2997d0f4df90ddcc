#pragma once

#include <cstdint>

#include "optics/path_tally.h"
#include "optics/photon_walk.h"

namespace alabaster {

/// The half-space walk of half_space_tally for one random stream: photons in single-precision vector lanes, a
/// lane taking the next photon when its own has left. Only exactly rounded operations (+ - * / sqrt and
/// bits), so the tally is the same whatever the instruction set.
/// When the tally has a normal view, every collision also tries to scatter straight up and leave unhindered
/// (a score for light leaving along the normal, at full resolution in angle); a score is worth
/// normal_view_score().
void walk_in_lanes(const WalkMedium& medium, uint64_t seed, uint64_t stream, uint64_t photons,
                   PathTally& tally);

/// Radial energy per score of the normal view, in units in which radiance along the normal is T(1)/(pi c)
/// times the energy: a perfectly Fresnel-weighted cosine would make it equal to that of all directions.
double normal_view_score(const WalkMedium& medium);

}  // namespace alabaster
