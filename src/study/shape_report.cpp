#include "study/shape_report.h"

#include <fmt/format.h>

#include <cmath>

#include "core/vec.h"
#include "optics/shape_families.h"
#include "report/chart.h"

namespace alabaster {

namespace {

// Factors over distance for some sizes.
Chart factors(const ShapeFamilies& shapes, ShapeFamily family, const std::string& title,
              const std::string& size_name) {
  constexpr double albedo = 0.9;
  const bool slab = ShapeGrid::is_slab(family);
  Chart chart;
  chart.title = fmt::format("{}, albedo {}", title, albedo);
  chart.x_label = slab ? "lateral distance / mean free path" : "chord / mean free path";
  chart.y_label = "S / S of the half-space at the same chord";
  chart.log_x = chart.log_y = true;
  for (const double size : {1.0, 3.0, 10.0, 30.0, 100.0}) {
    ChartSeries series;
    series.name = fmt::format("{} {}", size_name, size);
    series.points = false;
    const double last = slab ? std::max(10 * size, 30.0) : 2 * size;
    for (int k = 0; k <= 80; ++k) {
      const double d = 0.03 * std::pow(last / 0.03, k / 80.0);
      series.x.push_back(d);
      series.y.push_back(shapes.factor(family, size, d, albedo));
    }
    chart.series.push_back(series);
  }
  return chart;
}

// Over all of the surface, by steps of log distance.
double returned(const ShapeFamilies& shapes, const ProfileTable& half_space, ShapeFamily family, double size,
                double albedo) {
  constexpr int steps = 1000;
  const double first = 1e-4, last = ShapeGrid::is_slab(family) ? 30 * size + 300 : 2 * size;
  const double step = std::log(last / first) / steps;
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double d = first * std::exp((k + 0.5) * step);
    const double chord = family == ShapeFamily::slab_far ? std::hypot(d, size) : d;
    sum +=
        2 * pi * d * d * step * half_space.evaluate(albedo, chord) * shapes.factor(family, size, d, albedo);
  }
  return sum;
}

Chart totals(const ShapeFamilies& shapes, const ProfileTable& half_space) {
  Chart chart;
  chart.title = "Light that bodies return, over that of a half-space";
  chart.x_label = "radius or thickness / mean free path";
  chart.y_label = "returned / A";
  chart.log_x = chart.log_y = true;
  struct Body {
    const char* name;
    std::vector<ShapeFamily> families;
  };
  for (const Body& body : {Body{"ball", {ShapeFamily::ball}}, Body{"cavity", {ShapeFamily::cavity}},
                           Body{"slab, both sides", {ShapeFamily::slab_near, ShapeFamily::slab_far}}})
    for (const double albedo : {0.5, 0.99}) {
      ChartSeries series;
      series.name = fmt::format("{}, albedo {}", body.name, albedo);
      series.points = false;
      for (int k = 0; k <= 40; ++k) {
        const double size = 0.5 * std::pow(400.0, k / 40.0);
        double sum = 0;
        for (const ShapeFamily family : body.families)
          sum += returned(shapes, half_space, family, size, albedo);
        series.x.push_back(size);
        series.y.push_back(sum / half_space.reflectance(albedo));
      }
      chart.series.push_back(series);
    }
  return chart;
}

}  // namespace

void write_shape_report(const ShapeTable& table, const ProfileTable& half_space,
                        const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const ShapeFamilies shapes(table);
  write_chart_svg(folder / "shape_balls.svg", factors(shapes, ShapeFamily::ball, "Balls", "radius"));
  write_chart_svg(folder / "shape_cavities.svg",
                  factors(shapes, ShapeFamily::cavity, "Around cavities", "radius"));
  write_chart_svg(folder / "shape_slab_near.svg",
                  factors(shapes, ShapeFamily::slab_near, "Slabs, same side", "thickness"));
  write_chart_svg(folder / "shape_slab_far.svg",
                  factors(shapes, ShapeFamily::slab_far, "Slabs, far side", "thickness"));
  write_chart_svg(folder / "shape_returned.svg", totals(shapes, half_space));
}

}  // namespace alabaster
