#pragma once

#include <vector>

#include "bssrdf/bssrdf.h"

namespace alabaster {

/// S(alpha_bar, d), alpha_bar the uniform mean over an ellipse around the pair: Sone, Hachisuka, Koike 2017
/// [SHK17]. Their ellipse is an empirical bound; here its foci are the two points and its minor semi-axis is
/// width * d / 2, so width 0 is the segment between them.
class AggregateBssrdf final : public Bssrdf {
 public:
  /// `samples` 0: five pyramid lookups that have the ellipse's covariance and its marginal along the pair;
  /// otherwise that many points of the finest level, uniform in the ellipse, shifted at random from pair to
  /// pair.
  AggregateBssrdf(const BssrdfMedium& medium, const KernelPlacement& placement, double width, int samples);
  Rgb evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const override;
  Rgb typical_albedo(const BssrdfPoint& exit) const override;
  double typical_albedo_reach() const override;

 private:
  Rgb ellipse_mean(const BssrdfPoint& entry, const BssrdfPoint& exit, double distance) const;
  const KernelPlacement& placement_;
  double minor_, major_;  // semi-axes / d
  int samples_;
  std::vector<KernelTap> taps_;
};

}  // namespace alabaster
