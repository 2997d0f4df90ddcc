#pragma once
// Private to integrators/planar_*.cpp.

#include "integrators/planar_lane.h"

namespace alabaster {

/// PlanarEstimator::lattice for channels first .. first + channels - 1 (1 or 3), which have one mean free
/// path; a single channel is written to `outputs` channels from `first` on.
///
/// In a medium that is the same all along the plane but for its albedo, the way of a photon does not depend
/// on where it starts: only what it has left of its weight does. So one walk serves a lattice of photons that
/// covers the light, whole pixels apart and shifted at random as a whole, in all four quarter turns about the
/// normal. At a collision every photon's weight is multiplied by the albedo it meets, a row of the lattice
/// being a row of texels in steps of the lattice: eight photons to an instruction. Bilinear interpolation is
/// by chance, one draw for all photons: a product of albedos that are right in the mean, drawn independently,
/// is right in the mean.
std::unique_ptr<PlanarLane> make_lattice_lane(const PlanarScene& scene, int first, int channels, int outputs);

}  // namespace alabaster
