#include "bssrdf/homogeneous.h"

namespace alabaster {

Rgb HomogeneousBssrdf::evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
  PairShape shape = pair(entry, exit);
  take_distance(shape, entry, exit);
  return exit.albedo * basis_over_albedo(exit.albedo, shape);
}

}  // namespace alabaster
