#pragma once

#include <vector>

#include "optics/monotone_curve.h"
#include "optics/profile_table.h"
#include "optics/table_data.h"

namespace alabaster {

/// The basis by interpolation in a baked table: log(2 pi rho R / alpha) is linear in log rho between 16 nodes
/// per octave and a Catmull-Rom spline over the albedo rows, so its derivative by the albedo is continuous.
/// Below the first node rho R is constant, beyond the last a power law.
///
/// sample() draws from a density of its own, near R but simpler: linear in rho between the nodes and in the
/// row position between the rows, with a share of 1/(1 + rho)^2 that keeps it positive at every distance.
/// sample() is its exact quantile function (increasing in u).
class TabulatedProfile final : public ProfileTable {
 public:
  explicit TabulatedProfile(const TableData& data);

  double g() const override { return g_; }
  double eta() const override { return eta_; }
  double reflectance(double albedo) const override;
  double albedo_from_reflectance(double reflectance) const override;
  double evaluate_over_albedo(double albedo, double rho) const override;
  Rgb evaluate_over_albedo(const Rgb& albedo, double rho) const override;
  Rgb evaluate_over_albedo(const Rgb& albedo, const Rgb& rho) const override;
  double sample(double albedo, double u) const override;
  double pdf(double albedo, double rho) const override;
  /// Integral of pdf from 0 to rho: the inverse of sample().
  double cdf(double albedo, double rho) const;

 private:
  struct Row;

  Row sampled_row(double albedo) const;
  double blended(const std::vector<double>& table, const Row& row, int node) const;

  double g_, eta_;
  MonotoneCurve reflectance_over_albedo_;  // over the row position
  std::vector<double> reflectance_;        // at the rows: brackets for the inverse
  std::vector<float> log2_density_;        // [node][row + 1], a row added at either end for the spline
  std::vector<double> sampled_density_, sampled_cdf_;  // [node][row]
};

}  // namespace alabaster
