#pragma once

#include "bssrdf/bssrdf.h"

namespace alabaster {

/// sqrt(S(alpha_i, d) S(alpha_e, d)): Song et al. 2009, "SubEdit", [STPP09]. Reciprocal; blind to what lies
/// between.
class FactorizedBssrdf final : public Bssrdf {
 public:
  using Bssrdf::Bssrdf;
  Rgb evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const override;
};

}  // namespace alabaster
