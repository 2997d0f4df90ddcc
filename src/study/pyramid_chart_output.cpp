#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "report/html_report.h"
#include "study/pyramid_chart.h"

namespace alabaster {

namespace {

constexpr double float_texel = 16, byte_texel = 4;  // bytes of RGBA

nlohmann::ordered_json json_of(const PyramidMeasurements& m) {
  nlohmann::ordered_json json{{"side", m.side},
                              {"triangles", m.triangles},
                              {"charts", m.charts},
                              {"filled_texels", m.filled_texels},
                              {"space_from_texels", m.space_from},
                              {"truth_noise", m.truth_noise}};
  for (const PyramidCost& cost : m.costs)
    json["costs"].push_back({{"method", cost.method},
                             {"bytes_per_texel", cost.bytes_per_texel},
                             {"of_float_texture", cost.bytes_per_texel / float_texel},
                             {"of_byte_texture", cost.bytes_per_texel / byte_texel},
                             {"build_seconds", cost.build_seconds}});
  for (const PyramidRow& row : m.rows)
    json["rows"].push_back({{"pattern", row.pattern},
                            {"method", row.method},
                            {"sigma", row.sigma},
                            {"texels", row.texels},
                            {"rms", row.rms},
                            {"worst", row.worst},
                            {"nanoseconds", row.nanoseconds}});
  return json;
}

std::vector<std::string> patterns(const PyramidMeasurements& m) {
  std::vector<std::string> names;
  for (const PyramidRow& row : m.rows)
    if (names.empty() || names.back() != row.pattern) names.push_back(row.pattern);
  return names;
}

/// One curve per method over the width.
template <class Value>
Chart chart_by_width(const PyramidMeasurements& m, const std::string& pattern, const Value& value) {
  Chart chart;
  chart.x_label = "standard deviation, texels";
  chart.log_x = chart.log_y = true;
  for (const PyramidCost& cost : m.costs) {
    ChartSeries series{cost.method, {}, {}};
    for (const PyramidRow& row : m.rows)
      if (row.pattern == pattern && row.method == cost.method)
        series.x.push_back(row.texels), series.y.push_back(value(row));
    chart.series.push_back(std::move(series));
  }
  return chart;
}

Chart error_chart(const PyramidMeasurements& m, const std::string& pattern) {
  Chart chart = chart_by_width(m, pattern, [](const PyramidRow& row) { return 100 * row.worst; });
  chart.title = "Averages under a Gaussian on a surface of six charts: " + pattern;
  chart.y_label = "worst error, % of contrast";
  return chart;
}

Chart cost_chart(const PyramidMeasurements& m) {
  Chart chart =
      chart_by_width(m, m.rows.front().pattern, [](const PyramidRow& row) { return row.nanoseconds; });
  chart.title = "Cost of a lookup";
  chart.y_label = "CPU nanoseconds";
  return chart;
}

ReportTable error_table(const PyramidMeasurements& m, const std::string& pattern) {
  ReportTable table{"Root mean square / worst error, per cent of contrast", {"texels"}, {}};
  for (const PyramidCost& cost : m.costs) table.header.push_back(cost.method);
  table.header.emplace_back("noise of the truth");
  for (std::size_t i = 0; i < m.rows.size(); i += m.costs.size()) {
    if (m.rows[i].pattern != pattern) continue;
    std::vector<std::string> row{fmt::format("{:.1f}", m.rows[i].texels)};
    for (std::size_t k = 0; k < m.costs.size(); ++k)
      row.push_back(fmt::format("{:.2f} / {:.2f}", 100 * m.rows[i + k].rms, 100 * m.rows[i + k].worst));
    row.push_back(fmt::format("{:.2f}", 100 * m.truth_noise[i / m.costs.size()]));
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable cost_table(const PyramidMeasurements& m) {
  ReportTable table{"Memory and building",
                    {"method", "bytes per texel", "of float RGBA", "of 8-bit RGBA", "build, CPU s",
                     "lookup, ns (least to most over widths)"},
                    {}};
  for (const PyramidCost& cost : m.costs) {
    double least = 1e30, most = 0;
    for (const PyramidRow& row : m.rows)
      if (row.method == cost.method)
        least = std::min(least, row.nanoseconds), most = std::max(most, row.nanoseconds);
    table.rows.push_back({cost.method, fmt::format("{:.1f}", cost.bytes_per_texel),
                          fmt::format("{:.2f}", cost.bytes_per_texel / float_texel),
                          fmt::format("{:.2f}", cost.bytes_per_texel / byte_texel),
                          fmt::format("{:.2f}", cost.build_seconds),
                          fmt::format("{:.0f} to {:.0f}", least, most)});
  }
  return table;
}

}  // namespace

void chart_pyramids(const PyramidChartOptions& options) {
  const PyramidMeasurements m = measure_pyramids(options);
  write_text_atomically(options.output / "chart.json", json_of(m).dump(1) + "\n");
  HtmlReport report(
      "Alabaster: averages of albedo on a seamed surface",
      fmt::format(
          "A bumpy ball of {} triangles in {} charts, {} x {} texels; Gaussians on the surface against "
          "brute force at {} places per width. {} texels of gutters were filled from across seams; the "
          "pyramid over space begins at {:.1f} texels. Seed {}.",
          m.triangles, m.charts, m.side, m.side, options.places, m.filled_texels, m.space_from,
          options.seed));
  for (const std::string& pattern : patterns(m)) {
    const Chart chart = error_chart(m, pattern);
    write_chart_files(options.output / ("pyramid_errors_" + pattern), chart);
    report.heading("Errors: " + pattern);
    report.chart(chart, "worst error of every method over the width of the Gaussian, " + pattern);
    report.table(error_table(m, pattern));
  }
  const Chart costs = cost_chart(m);
  write_chart_files(options.output / "pyramid_lookups", costs);
  report.heading("Costs");
  report.chart(costs, "CPU time per lookup of every method over the width of the Gaussian");
  report.table(cost_table(m));
  report.write(options.output / "chart.html");
}

}  // namespace alabaster
