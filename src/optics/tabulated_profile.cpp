#include "optics/tabulated_profile.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "optics/fast_math.h"
#include "optics/radial_bins.h"
#include "optics/row_position.h"

namespace alabaster {

namespace {

constexpr int nodes = RadialBins::inner;
// The sampled density needs fewer rows.
constexpr int sampled_stride = 4, sampled_rows = (AlbedoRows::count - 1) / sampled_stride + 1;
static_assert((AlbedoRows::count - 1) % sampled_stride == 0);
constexpr double defensive_share = 1e-3;

double node_radius(int node) {
  static const std::vector<double> radii = [] {
    std::vector<double> all;
    for (int j = 0; j < nodes; ++j) all.push_back(RadialBins::centre(j + 1));
    return all;
  }();
  return radii[static_cast<std::size_t>(node)];
}
std::size_t sampled_index(int node, int row) {
  return static_cast<std::size_t>(node) * sampled_rows + static_cast<std::size_t>(row);
}

}  // namespace

int TabulatedProfile::node_below(double rho) {
  return std::min(static_cast<int>(node_position(fast_log2(static_cast<float>(rho)))), nodes - 2);
}

// Place between two rows of the sampled density.
struct TabulatedProfile::Row {
  int index;  // of the lower row, at most sampled_rows - 2
  double fraction;
};

TabulatedProfile::TabulatedProfile(const TableData& data)
    : g_(data.g),
      eta_(data.eta),
      reflectance_over_albedo_(data.reflectance_over_albedo),
      log2_density_(static_cast<std::size_t>(nodes) * spline_rows),
      sampled_density_(static_cast<std::size_t>(nodes) * sampled_rows),
      sampled_cdf_(static_cast<std::size_t>(nodes) * sampled_rows) {
  for (int i = 0; i < rows; ++i) reflectance_.push_back(AlbedoRows::albedo(i) * reflectance_over_albedo_(i));
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

double TabulatedProfile::reflectance(double albedo) const {
  albedo = std::clamp(albedo, 0.0, 1.0);
  return albedo * reflectance_over_albedo_(AlbedoRows::position(albedo));
}

double TabulatedProfile::albedo_from_reflectance(double reflectance) const {
  // Over the row position, which resolves alpha near 1; rows run from bright to dark.
  if (!(reflectance < reflectance_.front())) return 1;
  const auto darker = std::partition_point(reflectance_.begin(), reflectance_.end(),
                                           [&](double r) { return r > reflectance; });
  if (darker == reflectance_.end()) return AlbedoRows::albedo(rows - 1);
  const auto row = static_cast<double>(darker - reflectance_.begin());
  double low = row - 1, high = row;
  double above = *(darker - 1) - reflectance, below = *darker - reflectance;
  // Regula falsi; where one end stays, its weight is halved (the Illinois method).
  int side = 0;
  for (int step = 0; step < 60 && high - low > 1e-14 * row && below < 0; ++step) {
    double middle = (low * below - high * above) / (below - above);
    if (!(middle > low && middle < high)) middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) break;
    const double value = AlbedoRows::albedo(middle) * reflectance_over_albedo_(middle) - reflectance;
    if (value > 0) {
      low = middle, above = value;
      if (side == 1) below *= 0.5;
      side = 1;
    } else {
      high = middle, below = value;
      if (side == -1) above *= 0.5;
      side = -1;
    }
  }
  return AlbedoRows::albedo(high);
}

double TabulatedProfile::evaluate_over_albedo(double albedo, double rho) const {
  return evaluate_over_albedo(Rgb(albedo), Rgb(rho)).r;
}

Rgb TabulatedProfile::evaluate_over_albedo(const Rgb& albedo, double rho) const {
  return evaluate_over_albedo(albedo, Rgb(rho));
}

Rgb TabulatedProfile::evaluate_over_albedo(const Rgb& albedo, const Rgb& rho) const {
  const auto remainder = [](double a) { return static_cast<float>(std::min(std::max(1 - a, 0.0), 1.0)); };
  const Float4 remainders{remainder(albedo.r), remainder(albedo.g), remainder(albedo.b), 0};
  const Float4 distances{static_cast<float>(rho.r), static_cast<float>(rho.g), static_cast<float>(rho.b), 1};
  const Float4 density = fast_exp2(log2_density(fast_row_position(remainders), fast_log2(distances)));
  const double scale = 1 / (2 * pi);
  return {scale * double{density[0]} / rho.r, scale * double{density[1]} / rho.g,
          scale * double{density[2]} / rho.b};
}

TabulatedProfile::Row TabulatedProfile::sampled_row(double albedo) const {
  const double position =
      double{fast_row_position(static_cast<float>(1 - std::clamp(albedo, 0.0, 1.0)))} / sampled_stride;
  const int index = std::min(static_cast<int>(position), sampled_rows - 2);
  return {index, std::min(1.0, position - index)};
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
  const int j = node_below(rho);
  const double low = node_radius(j), high = node_radius(j + 1);
  const double t = std::clamp((rho - low) / (high - low), 0.0, 1.0);
  return (1 - t) * blended(sampled_density_, place, j) + t * blended(sampled_density_, place, j + 1);
}

double TabulatedProfile::cdf(double albedo, double rho) const {
  const Row place = sampled_row(albedo);
  const double last = node_radius(nodes - 1);
  if (rho <= node_radius(0)) return blended(sampled_density_, place, 0) * rho;
  if (rho >= last) return 1 - blended(sampled_density_, place, nodes - 1) * last * last / rho;
  const int j = node_below(rho);
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
