#include "bssrdf/homogeneous.h"

namespace alabaster {

Rgb HomogeneousBssrdf::evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
  return exit.albedo * basis_over_albedo(exit.albedo, basis_pair(pair(entry, exit), entry, exit));
}

}  // namespace alabaster
