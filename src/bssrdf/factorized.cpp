#include "bssrdf/factorized.h"

#include <cmath>

namespace alabaster {

Rgb FactorizedBssrdf::evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
  PairShape shape = pair(entry, exit);
  take_distance(shape, entry, exit);
  const Rgb at_exit = exit.albedo * basis_over_albedo(exit.albedo, shape);
  if (entry.albedo == exit.albedo) return at_exit;
  const Rgb product = at_exit * entry.albedo * basis_over_albedo(entry.albedo, shape);
  return {std::sqrt(product.r), std::sqrt(product.g), std::sqrt(product.b)};
}

}  // namespace alabaster
