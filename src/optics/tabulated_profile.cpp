#include "optics/tabulated_profile.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "optics/fast_math.h"
#include "optics/radial_bins.h"

namespace alabaster {

namespace {

constexpr int rows = AlbedoRows::count;
constexpr int nodes = RadialBins::inner;
constexpr int spline_rows = rows + 2;
// The sampled density needs fewer rows.
constexpr int sampled_stride = 4, sampled_rows = (rows - 1) / sampled_stride + 1;
static_assert((rows - 1) % sampled_stride == 0);
constexpr double first_log2 = RadialBins::first_octave + 0.5 / RadialBins::per_octave;
constexpr double defensive_share = 1e-3;

double node_radius(int node) {
  return RadialBins::centre(node + 1);
}
std::size_t sampled_index(int node, int row) {
  return static_cast<std::size_t>(node) * sampled_rows + static_cast<std::size_t>(row);
}

}  // namespace

struct TabulatedProfile::Node {
  int index;       // of the lower node, at most nodes - 2
  float fraction;  // in log rho; above 1 beyond the last node
};

struct TabulatedProfile::Row {
  int index;  // of the lower row, at most rows - 2
  double fraction;
};

TabulatedProfile::TabulatedProfile(const TableData& data)
    : g_(data.g),
      eta_(data.eta),
      reflectance_over_albedo_(data.reflectance_over_albedo),
      log2_density_(static_cast<std::size_t>(nodes) * spline_rows),
      sampled_density_(static_cast<std::size_t>(nodes) * sampled_rows),
      sampled_cdf_(static_cast<std::size_t>(nodes) * sampled_rows) {
  for (int j = 0; j < nodes; ++j) {
    float* row = &log2_density_[static_cast<std::size_t>(j) * spline_rows];
    for (int i = 0; i < rows; ++i)
      row[i + 1] = data.log2_density[static_cast<std::size_t>(i) * nodes + static_cast<std::size_t>(j)];
    row[0] = 2 * row[1] - row[2];
    row[spline_rows - 1] = 2 * row[spline_rows - 2] - row[spline_rows - 3];
  }
  for (int i = 0; i < sampled_rows; ++i) {
    const float* log2_row = &data.log2_density[static_cast<std::size_t>(i * sampled_stride * nodes)];
    std::vector<double> density(nodes);
    double total = 0;
    for (int j = 0; j < nodes; ++j) {
      const double rho = node_radius(j);
      density[static_cast<std::size_t>(j)] = std::exp2(double{log2_row[j]});
      total += density[static_cast<std::size_t>(j)] * rho * 0.6931471805599453 / RadialBins::per_octave;
    }
    for (int j = 0; j < nodes; ++j) {
      const double rho = node_radius(j);
      double& value = density[static_cast<std::size_t>(j)];
      value = (1 - defensive_share) * value / total + defensive_share / ((1 + rho) * (1 + rho));
    }
    // Constant up to the first node, linear between nodes, falling as rho^-2 beyond the last.
    double sum = density[0] * node_radius(0);
    for (int j = 0; j < nodes; ++j) {
      if (j > 0)
        sum += 0.5 * (density[static_cast<std::size_t>(j)] + density[static_cast<std::size_t>(j) - 1]) *
               (node_radius(j) - node_radius(j - 1));
      sampled_cdf_[sampled_index(j, i)] = sum;
    }
    sum += density[nodes - 1] * node_radius(nodes - 1);
    for (int j = 0; j < nodes; ++j) {
      sampled_density_[sampled_index(j, i)] = density[static_cast<std::size_t>(j)] / sum;
      sampled_cdf_[sampled_index(j, i)] /= sum;
    }
  }
}

TabulatedProfile::Node TabulatedProfile::node(double rho) const {
  const float x = std::max(
      0.f, (fast_log2(static_cast<float>(rho)) - static_cast<float>(first_log2)) * RadialBins::per_octave);
  const int index = std::min(static_cast<int>(x), nodes - 2);
  return {index, x - static_cast<float>(index)};
}

TabulatedProfile::Row TabulatedProfile::row(double albedo) const {
  constexpr auto inverse_knee = static_cast<float>(1 / AlbedoRows::knee);
  constexpr auto scale = static_cast<float>((rows - 1) / AlbedoRows::length);
  const auto remainder = static_cast<float>(1 - std::clamp(albedo, 0.0, 1.0));
  const float root = std::sqrt(remainder);
  const float position =
      scale * (fast_log2(1 + root * inverse_knee) + static_cast<float>(AlbedoRows::linear) * root);
  const int index = std::min(static_cast<int>(position), rows - 2);
  return {index, std::min(1.0, double{position} - index)};
}

double TabulatedProfile::reflectance(double albedo) const {
  albedo = std::clamp(albedo, 0.0, 1.0);
  return albedo * reflectance_over_albedo_(AlbedoRows::position(albedo));
}

double TabulatedProfile::albedo_from_reflectance(double reflectance) const {
  // Bisection over the row position, which resolves alpha near 1.
  double low = 0, high = rows - 1;
  for (int step = 0; step < 52; ++step) {
    const double middle = 0.5 * (low + high);
    const bool brighter = AlbedoRows::albedo(middle) * reflectance_over_albedo_(middle) > reflectance;
    (brighter ? low : high) = middle;
  }
  return low == 0 ? 1.0 : AlbedoRows::albedo(high);
}

float TabulatedProfile::log2_density(const Row& row, const Node& node) const {
  const auto t = static_cast<float>(row.fraction), s = 1 - t;
  const float weights[4] = {-0.5f * t * s * s, 1 + t * t * (1.5f * t - 2.5f), 1 + s * s * (1.5f * s - 2.5f),
                            -0.5f * s * t * t};
  const float* near = &log2_density_[static_cast<std::size_t>(node.index * spline_rows + row.index)];
  const float* far = near + spline_rows;
  float sum = 0;
  for (int k = 0; k < 4; ++k) sum += weights[k] * (near[k] + node.fraction * (far[k] - near[k]));
  return sum;
}

double TabulatedProfile::evaluate_over_albedo(double albedo, double rho) const {
  return 1 / (2 * pi * rho) * double{fast_exp2(log2_density(row(albedo), node(rho)))};
}

Rgb TabulatedProfile::evaluate_over_albedo(const Rgb& albedo, double rho) const {
  const Node place = node(rho);
  const double scale = 1 / (2 * pi * rho);
  const double red = scale * double{fast_exp2(log2_density(row(albedo.r), place))};
  if (albedo.is_grey()) return Rgb(red);
  return {red, scale * double{fast_exp2(log2_density(row(albedo.g), place))},
          scale * double{fast_exp2(log2_density(row(albedo.b), place))}};
}

Rgb TabulatedProfile::evaluate_over_albedo(const Rgb& albedo, const Rgb& rho) const {
  if (rho.is_grey()) return evaluate_over_albedo(albedo, rho.r);
  return {evaluate_over_albedo(albedo.r, rho.r), evaluate_over_albedo(albedo.g, rho.g),
          evaluate_over_albedo(albedo.b, rho.b)};
}

TabulatedProfile::Row TabulatedProfile::sampled_row(double albedo) const {
  const Row fine = row(albedo);
  const double position = (fine.index + fine.fraction) / sampled_stride;
  const int index = std::min(static_cast<int>(position), sampled_rows - 2);
  return {index, position - index};
}

double TabulatedProfile::blended(const std::vector<double>& table, const Row& row, int node) const {
  const double* at = &table[sampled_index(node, row.index)];
  return at[0] + row.fraction * (at[1] - at[0]);
}

double TabulatedProfile::pdf(double albedo, double rho) const {
  const Row place = sampled_row(albedo);
  const double last = node_radius(nodes - 1);
  if (rho <= node_radius(0)) return blended(sampled_density_, place, 0);
  if (rho >= last) return blended(sampled_density_, place, nodes - 1) * (last / rho) * (last / rho);
  const int j = node(rho).index;
  const double low = node_radius(j), high = node_radius(j + 1);
  const double t = std::clamp((rho - low) / (high - low), 0.0, 1.0);
  return (1 - t) * blended(sampled_density_, place, j) + t * blended(sampled_density_, place, j + 1);
}

double TabulatedProfile::cdf(double albedo, double rho) const {
  const Row place = sampled_row(albedo);
  const double last = node_radius(nodes - 1);
  if (rho <= node_radius(0)) return blended(sampled_density_, place, 0) * rho;
  if (rho >= last) return 1 - blended(sampled_density_, place, nodes - 1) * last * last / rho;
  const int j = node(rho).index;
  const double low = node_radius(j), width = node_radius(j + 1) - low;
  const double p0 = blended(sampled_density_, place, j), p1 = blended(sampled_density_, place, j + 1);
  const double t = std::clamp((rho - low) / width, 0.0, 1.0);
  return blended(sampled_cdf_, place, j) + width * t * (p0 + 0.5 * t * (p1 - p0));
}

double TabulatedProfile::sample(double albedo, double u) const {
  const Row place = sampled_row(albedo);
  if (u < blended(sampled_cdf_, place, 0)) return u / blended(sampled_density_, place, 0);
  const double last = node_radius(nodes - 1);
  if (u >= blended(sampled_cdf_, place, nodes - 1))
    return blended(sampled_density_, place, nodes - 1) * last * last / std::max(1 - u, 0x1p-53);
  int below = 0, above = nodes - 1;
  while (above - below > 1) {
    const int middle = (below + above) / 2;
    (u < blended(sampled_cdf_, place, middle) ? above : below) = middle;
  }
  // Inside, the density is p0 + (p1 - p0) t: the smaller root of a quadratic, in the form that does not
  // cancel.
  const double low = node_radius(below), width = node_radius(above) - low;
  const double p0 = blended(sampled_density_, place, below), p1 = blended(sampled_density_, place, above);
  const double target = (u - blended(sampled_cdf_, place, below)) / width;
  const double root = std::sqrt(std::max(0.0, p0 * p0 + 2 * (p1 - p0) * target));
  return low + width * std::clamp(2 * target / (p0 + root), 0.0, 1.0);
}

}  // namespace alabaster
