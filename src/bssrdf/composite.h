#pragma once

#include <span>

#include "bssrdf/bssrdf.h"

namespace alabaster {

/// [EK17] eq. 2: S_V = (alpha_i / alpha_t) S(alpha_t, d) (alpha_e / alpha_t), alpha_t the mean albedo under
/// the kernel of eq. 1, evaluated as (alpha_i alpha_e / alpha_t) (S/alpha)(alpha_t). 0 where alpha_i, alpha_e
/// or alpha_t is 0. One basis evaluation and three lookups per pair.
class CompositeBssrdf final : public Bssrdf {
 public:
  enum class Variant {
    eq2,
    symmetric,  // kernel averaged with its mirror image: reciprocal, six lookups
    view        // alpha_e is last_collision_albedo(): two lookups more
  };
  CompositeBssrdf(const BssrdfMedium& medium, const KernelPlacement& placement,
                  Variant variant = Variant::eq2);
  Rgb evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const override;
  Rgb typical_albedo(const BssrdfPoint& exit) const override;
  double typical_albedo_reach() const override;

 private:
  const KernelPlacement& placement_;
  Variant variant_;
  std::span<const KernelTap> taps_;
};

/// The same with light that scattered once set apart: it met one albedo, not two, so eq. 2 counts it with
/// alpha_i alpha_e / alpha_t, which has no bound as alpha_t -> 0. Here
/// S_V = alpha_t E(0) + (alpha_i alpha_e / alpha_t) (E(alpha_t) - E(0)), E = S/alpha: E(0) is order 1 alone
/// and the difference is O(alpha_t). Two basis evaluations.
class OrderOneApartBssrdf final : public Bssrdf {
 public:
  OrderOneApartBssrdf(const BssrdfMedium& medium, const KernelPlacement& placement);
  Rgb evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const override;
  Rgb typical_albedo(const BssrdfPoint& exit) const override;
  double typical_albedo_reach() const override;

 private:
  const KernelPlacement& placement_;
};

}  // namespace alabaster
