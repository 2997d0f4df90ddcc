#include "study/speed_accuracy_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "report/html_report.h"
#include "study/report_pictures.h"
#include "study/validation_output.h"

namespace alabaster {

namespace {

using Json = nlohmann::ordered_json;

Json all_rows(const ChartResult& result) {
  Json rows = Json::array();
  for (const ChartScene& scene : result.scenes)
    for (const ChartRow& row : scene.rows)
      rows.push_back({{"scene", row.scene},
                      {"method", row.method},
                      {"spp", row.spp},
                      {"seconds", row.seconds},
                      {"cpu_seconds", row.cpu_seconds},
                      {"rmse_over_rms", row.rmse_over_rms},
                      {"bias", row.bias},
                      {"noise", row.noise},
                      {"on_front", row.on_front},
                      {"error", row.error}});
  return rows;
}

ChartSeries front(const ChartScene& scene) {
  std::vector<const ChartRow*> rows;
  for (const ChartRow& row : scene.rows)
    if (row.on_front) rows.push_back(&row);
  std::sort(rows.begin(), rows.end(),
            [](const ChartRow* a, const ChartRow* b) { return a->cpu_seconds < b->cpu_seconds; });
  ChartSeries series{"Pareto front", {}, {}};
  series.points = false;
  series.emphasised = true;
  for (const ChartRow* row : rows) {
    series.x.push_back(row->cpu_seconds);
    series.y.push_back(row->error);
  }
  return series;
}

Chart chart_of(const ChartScene& scene) {
  Chart chart{scene.title.empty() ? scene.name : scene.title,
              "CPU seconds",
              "error, RMSE / RMS (the reference's noise removed)",
              true,
              true,
              {front(scene)}};
  for (const ChartRow& row : scene.rows) {
    auto series = std::find_if(chart.series.begin(), chart.series.end(),
                               [&](const ChartSeries& s) { return s.name == row.method; });
    if (series == chart.series.end()) series = chart.series.insert(series, {row.method, {}, {}});
    series->x.push_back(row.cpu_seconds);
    series->y.push_back(row.error);
  }
  return chart;
}

/// The row of each method with the most samples.
std::vector<const ChartRow*> last_rows(const ChartScene& scene) {
  std::vector<const ChartRow*> rows;
  for (const ChartRow& row : scene.rows) {
    const auto same = std::find_if(rows.begin(), rows.end(),
                                   [&](const ChartRow* other) { return other->method == row.method; });
    if (same == rows.end()) {
      rows.push_back(&row);
    } else if (row.spp > (*same)->spp) {
      *same = &row;
    }
  }
  return rows;
}

ReportTable method_table(const ChartScene& scene) {
  ReportTable table{fmt::format("{}: what each method ends at and what it costs", scene.name),
                    {"method", "error without noise", "CPU seconds to 5 % noise", "to 1 %",
                     "million samples per CPU second"},
                    {}};
  const double noise = noise_of(scene.reference.image);
  const double pixels = scene.reference.image.width() * scene.reference.image.height();
  for (const ChartRow* row : last_rows(scene))
    table.rows.push_back({row->method, fmt::format("{:.3f}", row->bias),
                          fmt::format("{:.3g}", seconds_to_noise(*row, noise, 0.05)),
                          fmt::format("{:.3g}", seconds_to_noise(*row, noise, 0.01)),
                          fmt::format("{:.2f}", 1e-6 * row->spp * pixels / row->cpu_seconds)});
  return table;
}

void scene_section(HtmlReport& report, const ChartScene& scene) {
  const Image& truth = scene.reference.image;
  const double white = white_level(truth);
  report.heading(scene.title.empty() || scene.title == scene.name
                     ? scene.name
                     : fmt::format("{} ({})", scene.title, scene.name));
  report.chart(chart_of(scene), "error over CPU time of every method on " + scene.name);
  report.table(method_table(scene));
  std::vector<ReportImage> images{picture(truth, white, "reference", "reference image of " + scene.name)};
  std::size_t composite = 1;
  for (const auto& [name, image] : scene.images) {
    if (name.rfind("composite", 0) == 0) composite = images.size();
    images.push_back(picture(image, white, name, name + " on " + scene.name));
  }
  const std::vector<int> handles = report.images(images, "", 200);
  if (handles.size() > 1) report.slider(handles, scene.name + ", any two", 0, composite);
}

HtmlReport page(const ChartResult& result, const ChartOptions& options) {
  HtmlReport report(
      "Alabaster: error and time",
      fmt::format("Every method's error against the converged volumetric reference over the CPU time it "
                  "took. Budgets {}, seed {}, {:.0f} s ({:.0f} CPU s).{}",
                  options.quality == Quality::quick ? "quick" : "full", options.seed, result.seconds,
                  result.cpu_seconds,
                  result.cancelled ? " Stopped before the end: some scenes are missing." : ""));
  report.paragraph(
      "A curve falls while the noise does and ends at the method's own error, which no time removes. The "
      "grey band is "
      "the Pareto front: what is the best for its time. `volume` is the reference's own method with few "
      "samples, `walk` "
      "the same with the albedo of the point that is seen, as production renderers have it.");
  list_left_out(report, result.scenes);
  for (const ChartScene& scene : result.scenes)
    if (!scene.rows.empty()) scene_section(report, scene);
  return report;
}

}  // namespace

double seconds_to_noise(const ChartRow& row, double reference_noise, double noise) {
  const double variance = std::max(0.0, row.noise * row.noise - reference_noise * reference_noise);
  return row.cpu_seconds * variance / (noise * noise);
}

void write_chart_result(const ChartResult& result, const ChartOptions& options) {
  write_text_atomically(options.output / "chart.json", all_rows(result).dump(1) + "\n");
  for (const ChartScene& scene : result.scenes) {
    if (scene.rows.empty()) continue;
    const Chart chart = chart_of(scene);
    write_chart_files(options.output / file_name_of(scene.name), chart);
  }
  page(result, options).write(options.output / "chart.html");
}

}  // namespace alabaster
