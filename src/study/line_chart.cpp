#include "study/line_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/html.h"

namespace alabaster {

namespace {

constexpr double width = 560, height = 340, left = 60, right = 170, top = 34, bottom = 46;

// Okabe and Ito's colours, told apart by most eyes.
constexpr const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                   "#e69f00", "#56b4e9", "#000000"};
constexpr const char* dashes[] = {"none", "6 3", "2 3", "8 3 2 3"};

/// 1, 2 or 5 times a power of ten, so that about `count` steps cover the range.
double nice_step(double range, int count) {
  const double raw = range / count, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power) return factor * power;
  return 10 * power;
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x, y, anchor,
                     html::escape(text));
}

}  // namespace

LineChart::LineChart(std::string title, std::string x_label, std::string y_label)
    : title_(std::move(title)), x_label_(std::move(x_label)), y_label_(std::move(y_label)) {}

void LineChart::add(const Series& series) {
  series_.push_back(series);
}

std::string LineChart::svg() const {
  double low = 1e300, high = -1e300, y_high = 1e-12;
  std::vector<double> ticks;
  for (const Series& s : series_)
    for (const auto& [x, y] : s.points) {
      low = std::min(low, x);
      high = std::max(high, x);
      y_high = std::max(y_high, y);
      if (std::find(ticks.begin(), ticks.end(), x) == ticks.end()) ticks.push_back(x);
    }
  const auto scaled = [&](double x) { return logarithmic_x ? std::log(x) : x; };
  const double span = std::max(scaled(high) - scaled(low), 1e-12);
  const auto px = [&](double x) { return left + (scaled(x) - scaled(low)) / span * (width - left - right); };
  const double step = nice_step(y_high, 5), y_top = step * std::ceil(y_high / step);
  const auto py = [&](double y) {
    return height - bottom - std::max(y, 0.0) / y_top * (height - top - bottom);
  };

  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\" aria-label=\"{2}\" "
      "font-family=\"sans-serif\" "
      "font-size=\"12\"><rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>",
      width, height, html::escape(title_));
  svg += "<g font-size=\"14\" font-weight=\"bold\">" + text_at(left, 20, "start", title_) + "</g>";
  for (double y = 0; y <= y_top + 0.5 * step; y += step) {
    svg += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>", left,
                       width - right, py(y), py(y));
    svg += text_at(left - 6, py(y) + 4, "end", fmt::format("{:.3g}", y));
  }
  for (const double x : ticks) {
    svg += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"#888\"/>", px(x),
                       height - bottom, height - bottom + 4);
    svg += text_at(px(x), height - bottom + 17, "middle", fmt::format("{:.3g}", x));
  }
  svg += text_at(0.5 * (left + width - right), height - 8, "middle", x_label_);
  svg += fmt::format("<g transform=\"translate(14 {:.1f}) rotate(-90)\">{}</g>",
                     0.5 * (top + height - bottom), text_at(0, 0, "middle", y_label_));
  for (std::size_t i = 0; i < series_.size(); ++i) {
    const char* colour = colours[i % std::size(colours)];
    const char* dash = dashes[i / std::size(colours) % std::size(dashes)];
    std::string line, marks;
    for (const auto& [x, y] : series_[i].points) {
      line += fmt::format("{:.1f},{:.1f} ", px(x), py(y));
      marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>", px(x), py(y));
    }
    const double legend = top + 8 + 17 * static_cast<double>(i);
    svg += fmt::format(
        "<g fill=\"{0}\"><polyline points=\"{1}\" fill=\"none\" stroke=\"{0}\" stroke-width=\"1.6\" "
        "stroke-dasharray=\"{2}\"/>{3}"
        "<line x1=\"{4}\" x2=\"{5}\" y1=\"{6}\" y2=\"{6}\" stroke=\"{0}\" stroke-width=\"2\" "
        "stroke-dasharray=\"{2}\"/></g>",
        colour, line, dash, marks, width - right + 12, width - right + 34, legend);
    svg += text_at(width - right + 40, legend + 4, "start", series_[i].name);
  }
  return svg + "</svg>";
}

}  // namespace alabaster
