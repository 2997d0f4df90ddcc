#pragma once

#include <array>
#include <vector>

#include "optics/monotone_curve.h"
#include "optics/profile_table.h"
#include "optics/table_data.h"

namespace alabaster {

/// The basis as [EK17] has it: five exponentials in the [CB15] form whose parameters are interpolated over
/// the albedo, smoothly and monotonically between rows. Sampling draws an exponential, so the density is the
/// profile itself, but for a share of 1/(1 + rho)^2 that keeps it positive where the exponentials underflow.
class MixtureProfile final : public ProfileTable {
 public:
  explicit MixtureProfile(const TableData& data);

  double g() const override { return g_; }
  double eta() const override { return eta_; }
  double reflectance(double albedo) const override;
  double albedo_from_reflectance(double reflectance) const override;
  using ProfileTable::evaluate_over_albedo;
  double evaluate_over_albedo(double albedo, double rho) const override;
  double sample(double albedo, double u) const override;
  double pdf(double albedo, double rho) const override;

 private:
  struct Component {
    double weight, rate;
  };
  /// All components at a row position, weights scaled to the simulated A / alpha.
  std::array<Component, TableData::mixture_size> components(double position) const;

  double g_, eta_;
  MonotoneCurve reflectance_over_albedo_;       // over the row position
  std::vector<MonotoneCurve> weights_, rates_;  // a_k / alpha and lambda_k over the row position
};

}  // namespace alabaster
