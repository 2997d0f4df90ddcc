#include "bssrdf/homogeneous.h"

namespace alabaster {

Rgb HomogeneousBssrdf::evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
  const double distance = glm::distance(entry.surface.position, exit.surface.position);
  return exit.albedo * basis_over_albedo(exit.albedo, distance);
}

}  // namespace alabaster
