#pragma once

#include "study/planar_method.h"

namespace alabaster {

/// The method's image with RMSE/RMS noise of at most `noise` (sqrt(mean variance / mean square) over pixels
/// and channels, from the image's own variance channels) at the least cost: pixels get samples in proportion
/// to the standard deviation of one, in two scrambled sets. Those shares come from a pilot with numbers of
/// its own, radii around the light, so the image is unbiased; dim pixels are noisier, relative to themselves,
/// than in an image of render_planar(). Light on the whole plane: shares are equal. Stops early when
/// cancellation was asked for.
TimedImage render_planar_to_noise(const PlanarScene& scene, const PlanarMethod& method,
                                  const ProfileTable& profile, double noise, uint64_t seed);

}  // namespace alabaster
