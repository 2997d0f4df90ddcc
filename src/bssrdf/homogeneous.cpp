#include "bssrdf/homogeneous.h"

namespace alabaster {

Rgb HomogeneousBssrdf::evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
  return exit.albedo * basis_over_albedo(exit.albedo, pair(entry, exit));
}

}  // namespace alabaster
