#include "bssrdf/surroundings.h"

#include <algorithm>

namespace alabaster {

Rgb albedo_around(const BssrdfMedium& medium, const KernelPlacement& placement, const BssrdfPoint& exit) {
  const double sigma = 2 / medium.sigma_t.mean();
  const Rgb mean = medium.albedo->filtered(placement.around(exit.surface, sigma));
  const Rgb floor = 0.01 * medium.albedo->max();
  return {std::max(mean.r, floor.r), std::max(mean.g, floor.g), std::max(mean.b, floor.b)};
}

}  // namespace alabaster
