#include "study/response_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "image/false_colour.h"
#include "report/html_report.h"
#include "study/report_pictures.h"

namespace alabaster {

namespace {

using Json = nlohmann::ordered_json;

struct Cell {
  double value = 0, error = 0;  // and 95 % interval
};

Cell cell(const ResponseSums& sums, std::size_t bin, std::size_t contrast) {
  return {sums.value[bin][contrast], 1.96 * std::sqrt(sums.variance[bin][contrast])};
}

/// Over all contrasts.
Cell cell(const ResponseSums& sums, std::size_t bin) {
  Cell all;
  double variance = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    all.value += sums.value[bin][k];
    variance += sums.variance[bin][k];
  }
  all.error = 1.96 * std::sqrt(variance);
  return all;
}

Json all_rows(const std::vector<ResponseResult>& results) {
  Json rows = Json::array();
  for (const ResponseResult& result : results)
    for (const auto& [name, sums] : result.methods)
      for (std::size_t bin = 0; bin < ResponseBins::count; ++bin)
        for (std::size_t k = 0; k < 3; ++k) {
          const Cell truth = cell(result.reference, bin, k), value = cell(sums, bin, k);
          if (truth.value == 0 && value.value == 0) continue;
          const int b = static_cast<int>(bin);
          rows.push_back(
              {{"scene", result.scene},
               {"exit", result.exit.name},
               {"model", name},
               {"distance_low", ResponseBins::low(b)},
               {"distance_high", ResponseBins::high(b)},
               {"contrast", name_of(static_cast<Contrast>(k))},
               {"reference", truth.value},
               {"reference_interval", truth.error},
               {"value", value.value},
               {"relative_error", truth.value > 0 ? Json(value.value / truth.value - 1) : Json(nullptr)}});
        }
  return rows;
}

std::string to_csv(const Json& rows) {
  std::string text =
      "scene,exit,model,distance_low,distance_high,contrast,reference,reference_interval,value,relative_"
      "error\n";
  for (const Json& row : rows) {
    std::string line;
    for (const auto& [key, value] : row.items())
      line += (line.empty() ? "" : ",") + (value.is_string() ? value.get<std::string>()
                                           : value.is_null() ? ""
                                                             : value.dump());
    text += line + '\n';
  }
  return text;
}

/// The reference is known well enough for a relative error: to 10 %.
bool known(const Cell& truth) {
  return truth.value > 10 * truth.error / 1.96 && truth.value > 0;
}

Chart error_chart(const ResponseResult& result, const std::string& title,
                  const std::function<Cell(const ResponseSums&, std::size_t)>& pick) {
  Chart chart{title, "distance, mean free paths", "ln(method / reference)", true, false, {}};
  for (const auto& [name, sums] : result.methods) {
    ChartSeries series{name, {}, {}};
    for (std::size_t bin = 1; bin < ResponseBins::count; ++bin) {
      const Cell truth = pick(result.reference, bin), value = pick(sums, bin);
      if (!known(truth) || !(value.value > 0)) continue;
      const int b = static_cast<int>(bin);
      series.x.push_back(std::sqrt(ResponseBins::low(b) * ResponseBins::high(b)));
      series.y.push_back(std::clamp(std::log(value.value / truth.value), -3.0, 3.0));
    }
    if (!series.x.empty()) chart.series.push_back(std::move(series));
  }
  return chart;
}

/// A value per triangle as the camera sees it; NaN shows elsewhere as the scale's lowest.
template <class Value>
std::vector<float> on_surface(const ResponseResult& result, Value value) {
  std::vector<float> pixels;
  const Image& seen = result.triangles;
  for (int y = 0; y < seen.height(); ++y)
    for (int x = 0; x < seen.width(); ++x) {
      const bool there = seen.at(0, x, y) == static_cast<float>(result.exit.object);
      pixels.push_back(there ? static_cast<float>(value(static_cast<std::size_t>(seen.at(1, x, y)))) : 0.0f);
    }
  return pixels;
}

ReportImage map_picture(const ResponseResult& result, const std::vector<float>& values,
                        const ColourScale& scale, const std::string& label, const std::string& alt) {
  const Pixels8 picture = false_colour(values, result.triangles.width(), result.triangles.height(), scale);
  return {with_legend(picture, scale), label, alt + " on " + result.scene};
}

void add_maps(HtmlReport& report, const ResponseResult& result) {
  const std::vector<double>& truth = result.reference.by_triangle;
  ColourScale densities;
  densities.logarithmic = true;
  const std::vector<float> seen = on_surface(result, [&](std::size_t t) { return truth[t]; });
  densities.high = static_cast<double>(*std::max_element(seen.begin(), seen.end()));
  densities.low = 1e-5 * densities.high;
  if (!(densities.high > 0)) return;
  ColourScale ratios;
  ratios.is_signed = true;
  ratios.high = 1.5;
  std::vector<ReportImage> maps{
      map_picture(result, seen, densities, "reference, 1/m²", "the reference's response")},
      errors;
  for (const auto& [name, sums] : result.methods) {
    const std::vector<double>& values = sums.by_triangle;
    maps.push_back(map_picture(result, on_surface(result, [&](std::size_t t) { return values[t]; }),
                               densities, name, "response of " + name));
    const auto ratio = [&](std::size_t t) {
      return truth[t] > 0 && values[t] > 0 ? std::log(values[t] / truth[t]) : 0;
    };
    errors.push_back(map_picture(result, on_surface(result, ratio), ratios, name + ", ln(method / reference)",
                                 "error of " + name));
  }
  report.images(maps, "S_V by triangle, logarithmic, one scale.", 256);
  report.images(
      errors, "Blue: too little, red: too much. Triangles far away hold few of the reference's walks.", 256);
}

void add_section(HtmlReport& report, const ResponseResult& result) {
  report.heading(fmt::format("{}, {} exit", result.scene, result.exit.name));
  const Vec3& p = result.exit.surface.position;
  report.paragraph(
      fmt::format("Exit at ({:.4g}, {:.4g}, {:.4g}), albedo {:.3f}. Of the light that crossed the surface "
                  "there, {:.4f} scattered and left; by the models: {}.",
                  p.x, p.y, p.z, result.exit.albedo.mean(), result.reference.total(), [&] {
                    std::string text;
                    for (const auto& [name, sums] : result.methods)
                      text += fmt::format("{}{} {:.4f}", text.empty() ? "" : ", ", name, sums.total());
                    return text;
                  }()));
  const auto add_chart = [&](const Chart& chart) {
    if (!chart.series.empty()) report.chart(chart, chart.title + ": error of each method over the distance");
  };
  add_chart(error_chart(result, "All entry points",
                        [](const ResponseSums& s, std::size_t bin) { return cell(s, bin); }));
  for (std::size_t k = 0; k < 3; ++k)
    add_chart(error_chart(
        result, fmt::format("Entry points of {} contrast to the exit", name_of(static_cast<Contrast>(k))),
        [k](const ResponseSums& s, std::size_t bin) { return cell(s, bin, k); }));
  add_maps(report, result);
}

}  // namespace

void write_response(const std::vector<ResponseResult>& results, const ValidationOptions& options) {
  const Json rows = all_rows(results);
  write_text_atomically(options.output / "response.json", rows.dump(1) + "\n");
  write_text_atomically(options.output / "response.csv", to_csv(rows));
  HtmlReport report(
      "Alabaster: response of points",
      "S_V(x_i, x_e) over the mesh for chosen exit points x_e: every method against a tally of random "
      "walks from x_e. The mean over the channels; contrast is the difference of the albedos at both "
      "ends: low below 0.1, middle below 0.3, high above.");
  for (const ResponseResult& result : results) add_section(report, result);
  report.write(options.output / "response.html");
}

}  // namespace alabaster
