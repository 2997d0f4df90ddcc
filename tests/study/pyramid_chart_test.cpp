#include "study/pyramid_chart.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "support/paths.h"

using namespace alabaster;

namespace {

PyramidChartOptions small() {
  PyramidChartOptions options;
  options.side = 128;
  options.places = 8;
  options.points = 2000;
  return options;
}

}  // namespace

TEST_CASE("the chart of pyramids measures every way to average at every width") {
  const PyramidMeasurements m = measure_pyramids(small());
  CHECK(m.charts == 6);
  CHECK(m.filled_texels > 0);
  REQUIRE(m.costs.size() == 6);
  REQUIRE(m.rows.size() == m.costs.size() * m.truth_noise.size());
  double plain = 0, chosen = 0, widest = 0;
  for (std::size_t i = 0; i < m.rows.size(); ++i) {
    const PyramidRow& row = m.rows[i];
    CHECK(row.method == m.costs[i % 6].method);
    CHECK(row.worst >= row.rms);
    CHECK(row.nanoseconds > 0);
    widest = std::max(widest, row.sigma);
    if (row.method == "plain mip") plain = std::max(plain, row.rms);
    if (row.method == "chosen") chosen = std::max(chosen, row.rms);
  }
  CHECK(widest == 0.5);
  CHECK(plain > 5 * chosen);
  for (const PyramidCost& cost : m.costs) {
    CHECK(cost.bytes_per_texel > 0);
    CHECK(cost.build_seconds >= 0);
  }
  CHECK(m.costs.back().bytes_per_texel == Approx(m.costs[3].bytes_per_texel + m.costs[4].bytes_per_texel));
}

TEST_CASE("the chart of pyramids is written as pictures, a page and JSON") {
  const ScratchFolder folder;
  PyramidChartOptions options = small();
  options.side = 64;
  options.places = 2;
  options.points = 200;
  options.output = folder / "out";
  chart_pyramids(options);
  for (const char* name : {"pyramid_errors_stripes.svg", "pyramid_errors_cubes.svg", "pyramid_lookups.svg"})
    CHECK(read_text(options.output / name).find("<svg") != std::string::npos);
  const auto json = nlohmann::json::parse(read_text(options.output / "chart.json"));
  CHECK(json["costs"].size() == 6);
  CHECK(json["rows"].size() % 6 == 0);
  CHECK(read_text(options.output / "chart.html").find("seam-aware") != std::string::npos);
}
