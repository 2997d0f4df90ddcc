#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace alabaster {

/// One curve or cloud of points.
struct ChartSeries {
  std::string name;               // in the key
  std::vector<double> x, y;       // of one length
  std::vector<double> y_error{};  // half the error bar, in units of y; empty: none
  bool line = true, points = true;
  bool emphasised = false;  // a broad grey band (a Pareto front, a reference); put it first, below the rest
};

struct Chart {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<ChartSeries> series;
  int width = 800, height = 520;  // px
};

/// Draws with gnuplot. Colours are the colour-blind-safe ones of Okabe and Ito (2008); point and dash types
/// differ as well, so that a chart reads in grey. Points that are not finite, or not positive on a
/// logarithmic axis, are left out. Throws InputError when gnuplot is missing or fails, or when no point is
/// left.
std::string chart_svg(const Chart& chart);
/// Write the file whole or not at all.
void write_chart_svg(const std::filesystem::path& path, const Chart& chart);
void write_chart_png(const std::filesystem::path& path, const Chart& chart);
/// Both, as STEM.svg and STEM.png.
void write_chart_files(const std::filesystem::path& stem, const Chart& chart);

/// The gnuplot script of a chart with its data, as it is run: terminal is "svg" or "png".
std::string gnuplot_script(const Chart& chart, const std::string& terminal,
                           const std::filesystem::path& output);

}  // namespace alabaster
