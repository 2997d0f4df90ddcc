#pragma once

#include <vector>

#include "optics/fast_math.h"
#include "optics/monotone_curve.h"
#include "optics/profile_table.h"
#include "optics/radial_bins.h"
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
  /// log2 of 2 pi rho R / alpha in three channels (the last lane is of no use), at their positions among the
  /// rows of albedo (fast_row_position) and the logarithms of their distances.
  Float4 log2_density(Float4 row_position, Float4 log2_rho) const;
  double sample(double albedo, double u) const override;
  double pdf(double albedo, double rho) const override;
  /// Integral of pdf from 0 to rho: the inverse of sample().
  double cdf(double albedo, double rho) const;

 private:
  static constexpr int rows = AlbedoRows::count, nodes = RadialBins::inner, spline_rows = rows + 2;
  static constexpr double first_log2 = RadialBins::first_octave + 0.5 / RadialBins::per_octave;
  struct Row;

  static int node_below(double rho);
  Row sampled_row(double albedo) const;
  double blended(const std::vector<double>& table, const Row& row, int node) const;

  double g_, eta_;
  MonotoneCurve reflectance_over_albedo_;  // over the row position
  std::vector<double> reflectance_;        // at the rows: brackets for the inverse
  std::vector<float> log2_density_;        // [node][row + 1], a row added at either end for the spline
  std::vector<double> sampled_density_, sampled_cdf_;  // [node][row]

  /// Position among the radial nodes, at least 0.
  template <typename Float>
  static Float node_position(Float log2_rho) {
    const Float x = (log2_rho - static_cast<float>(first_log2)) * float{RadialBins::per_octave};
    const Float zero = x - x;
    return x > zero ? x : zero;
  }
};

// Catmull-Rom over the rows, linear over the nodes.
inline Float4 TabulatedProfile::log2_density(Float4 row_position, Float4 log2_rho) const {
  const Float4 distance = node_position(log2_rho);
  Int4 row = to_integer(row_position), node = to_integer(distance);
  const Int4 last_row = row - row + (rows - 2), last_node = row - row + (nodes - 2);
  row = row < last_row ? row : last_row;
  node = node < last_node ? node : last_node;
  const Float4 t = row_position - to_float(row), s = 1.f - t, along = distance - to_float(node);
  const Int4 place = node * spline_rows + row;
  const auto tap = [&](int lane) {
    const float* corner = log2_density_.data() + static_cast<uint32_t>(place[lane]);
    const Float4 near = load4(corner), far = load4(corner + spline_rows);
    return near + along[lane] * (far - near);
  };
  Float4 taps[4];
  columns(tap(0), tap(1), tap(2), taps);
  return s * t * (-0.5f * s * taps[0] - 0.5f * t * taps[3]) + (1.f + t * t * (1.5f * t - 2.5f)) * taps[1] +
         (1.f + s * s * (1.5f * s - 2.5f)) * taps[2];
}

}  // namespace alabaster
