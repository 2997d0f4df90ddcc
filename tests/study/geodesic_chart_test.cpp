#include "study/geodesic_chart.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace alabaster;

TEST_CASE("the chart of geodesics measures every method on every surface") {
  GeodesicChartOptions options;
  options.pairs = 20;
  const auto rows = measure_geodesics(options);
  CHECK(rows.size() == 4 * 6 * 2);
  const auto row = [&](const char* surface, const char* method, bool far) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const GeodesicRow& r) {
      return r.surface == surface && r.method == method && (r.shortest > 0.2) == far;
    });
    REQUIRE(found != rows.end());
    CHECK(found->pairs == 20);
    CHECK(found->microseconds > 0);
    return *found;
  };
  for (const bool far : {false, true}) {
    CHECK(row("plane", "chord", far).mean_error < 1e-6);
    CHECK(row("plane", "straightest path", far).mean_error < 1e-6);
    CHECK(row("plane", "edge graph", far).bias > 0.02);  // never short, never exact
    CHECK(row("sphere", "normal-corrected chord", far).mean_error < 0.002);
    CHECK(row("sphere", "chord", far).bias < 0);
    CHECK(row("blob", "chord", far).bias < 0);
    CHECK(row("fold", "chord", far).bias < 0);
  }
  CHECK(row("blob", "straightest path", false).mean_error < 0.01);
  CHECK(row("sphere", "chord", true).mean_error > 10 * row("sphere", "chord", false).mean_error);
}
