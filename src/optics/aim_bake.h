#pragma once

#include "optics/photon_walk.h"
#include "optics/shape_table.h"

namespace alabaster {

/// How light aimed from one end at the other is favoured: of a half-space, S for light that comes in along -w
/// over its mean over directions is, to first order, 1 + b(rho, alpha) w . u, u the unit vector from the exit
/// to the entry. From the mean of w . u where photons leave, over that of its square for the Fresnel-weighted
/// cosine, tallied by order. Returns b at the nodes and rows of AimGrid, [node][row], smoothed over the
/// nodes. Scalar walks; depends on photons and seed alone.
std::vector<double> bake_aim(const WalkMedium& medium, uint64_t photons, uint64_t seed);

}  // namespace alabaster
