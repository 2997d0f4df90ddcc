#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace alabaster {

/// One approximation of distances over one surface, over pairs of a range of true distances.
struct GeodesicRow {
  std::string surface, method;
  double shortest = 0, longest = 0;        // true distances, in radii of the surface
  double mean_error = 0, worst_error = 0;  // |distance / truth - 1|
  double bias = 0;                         // mean of distance / truth - 1
  int pairs = 0, refused = 0;              // all; those for which the method found no way
  double microseconds = 0;                 // CPU time per query
  double setup_seconds = 0;                // CPU time once per mesh
};

struct GeodesicChartOptions {
  std::filesystem::path output;  // folder
  uint64_t seed = 1;
  int pairs = 100;  // about, per surface and range
};

/// Every method of geometry/geodesic.h on a plane and a sphere (truth: closed forms), a bumpy blob and a
/// folded sheet (truth: the shorter of the straightest path and a Steiner graph's).
std::vector<GeodesicRow> measure_geodesics(const GeodesicChartOptions& options);

/// Measures and writes chart.json, geodesic_SURFACE.svg and .png, and chart.html.
void chart_geodesics(const GeodesicChartOptions& options);

}  // namespace alabaster
