#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace alabaster {

/// One way to average, at one width of the Gaussian, against brute force over the mesh.
struct PyramidRow {
  std::string pattern, method;
  double sigma = 0, texels = 0;  // standard deviation: in radii of the object; in texels on the surface
  double rms = 0, worst = 0;     // error as a fraction of the pattern's contrast
  double nanoseconds = 0;        // CPU time per lookup
};

/// What one way to average takes, beside the picture itself.
struct PyramidCost {
  std::string method;
  double bytes_per_texel = 0;  // everything a lookup reads, the finest level included
  double build_seconds = 0;    // CPU time
};

struct PyramidMeasurements {
  int side = 0;  // of the texture, texels
  std::size_t triangles = 0, charts = 0, filled_texels = 0;
  double space_from = 0;  // texels: finest deviation of the pyramid over space
  std::vector<PyramidRow> rows;
  std::vector<PyramidCost> costs;
  /// By pattern and width, in the order of the rows: what is uncertain about the truth (root mean square over
  /// the places, fraction of contrast).
  std::vector<double> truth_noise;
};

struct PyramidChartOptions {
  std::filesystem::path output;  // folder
  uint64_t seed = 1;
  int side = 1024;     // of the texture, texels
  int places = 40;     // per width
  int points = 20000;  // of the brute force, per place
};

/// Ways to average albedo under a Gaussian on the surface of a bumpy ball in six charts: a plain mip pyramid,
/// one whose gutters are padded, one weighted by coverage, one with gutters filled across seams, the pyramid
/// over space and the one that scenes use, which is of the last two. Truth: area-weighted means of points on
/// the mesh under a Gaussian of the geodesic distance.
PyramidMeasurements measure_pyramids(const PyramidChartOptions& options);

/// Measures and writes chart.json, pyramid_errors_PATTERN and pyramid_lookups as .svg and .png, and
/// chart.html.
void chart_pyramids(const PyramidChartOptions& options);

}  // namespace alabaster
