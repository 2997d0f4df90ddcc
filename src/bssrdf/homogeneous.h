#pragma once

#include "bssrdf/bssrdf.h"

namespace alabaster {

/// S(alpha_e, d): the albedo at the exit only, as production renderers do.
class HomogeneousBssrdf final : public Bssrdf {
 public:
  using Bssrdf::Bssrdf;
  Rgb evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const override;
};

}  // namespace alabaster
