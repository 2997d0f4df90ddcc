#include "bssrdf/surroundings.h"

#include <algorithm>

namespace alabaster {

namespace {

double deviation(const BssrdfMedium& medium) {
  return 2 / medium.sigma_t.mean();
}

}  // namespace

double smooth_distance(const BssrdfMedium& medium) {
  return 0.25 * deviation(medium);
}

Rgb albedo_around(const BssrdfMedium& medium, const KernelPlacement& placement, const BssrdfPoint& exit) {
  const Rgb mean = medium.albedo->filtered(placement.around(exit.surface, deviation(medium), Vec3(0)));
  const Rgb floor = 0.01 * medium.albedo->max();
  return {std::max(mean.r, floor.r), std::max(mean.g, floor.g), std::max(mean.b, floor.b)};
}

}  // namespace alabaster
