#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace alabaster {

// The aggregation kernel looked for where [EK17] found it (its steps 1 and 2): the distribution of the
// vertices of light paths between where they entered and where they left, seen from above, in the frame of
// the pair: (0, 0) the entry, (1, 0) the exit, lengths in their distance d.

struct FootprintOptions {
  double g = 0.3, eta = 1.5;
  std::vector<double> distances{0.5, 1, 2, 5};  // optical
  double tolerance = 0.05;                      // relative half-width of the distances that count
  /// Every vertex of a path of order n counts albedo^n; 1: unweighted, as in the paper.
  double albedo = 1;
  /// Longer paths are left out. Unweighted, the mean number of vertices grows with this without end.
  int max_order = 100;
  uint64_t paths = 1000000;
  uint64_t seed = 1;
};

/// Three isotropic Gaussians on the line through the pair, standard deviation equal to the mean's distance
/// from the entry: the form of eq. 1. Decreasing weights; the default is the paper's.
struct FootprintFit {
  std::array<double, 3> weight{4.0 / 7, 2.0 / 7, 1.0 / 7};
  std::array<double, 3> position{4.0 / 7, 2.0 / 7, 1.0 / 7};
  /// Per unit area of the pair's frame.
  double density(double along, double across) const { return std::exp(log_density(along, across)); }
  double log_density(double along, double across) const;
};

struct Footprint {
  double distance = 0;                           // optical
  static constexpr int columns = 96, rows = 64;  // along -1 .. 2, across -1 .. 1
  std::vector<double> density;                   // per unit area, row by row from across = -1
  uint64_t paths = 0;                            // that left at this distance
  double vertices_per_path = 0;
  double inside = 0;      // share of the vertices within the map
  double mean_along = 0;  // of all vertices
  double deviation_along = 0, deviation_across = 0;
  FootprintFit fit;                // of greatest likelihood, over all vertices
  double log_likelihood_gain = 0;  // mean per vertex, of the fit over eq. 1

  static double along(int column) { return -1 + 3 * (column + 0.5) / columns; }
  static double across(int row) { return -1 + 2 * (row + 0.5) / rows; }
};

/// One footprint per distance; reproducible at any number of threads.
std::vector<Footprint> measure_footprints(const FootprintOptions& options);

/// A weighted point of the pair's frame, and the fit of greatest likelihood to many (expectation-maximisation
/// from eq. 1's values).
struct FootprintVertex {
  float along, across, weight;
};
FootprintFit fit_footprint(const std::vector<FootprintVertex>& vertices);

}  // namespace alabaster
