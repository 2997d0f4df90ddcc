#pragma once

#include <string>
#include <utility>
#include <vector>

namespace alabaster {

/// A small line chart as inline SVG, for pages that need no other program: labelled axes from 0 (y), one line
/// with marks per series, a legend. Lines differ in dash and mark as well as in colour.
class LineChart {
 public:
  struct Series {
    std::string name;
    std::vector<std::pair<double, double>> points;
  };
  LineChart(std::string title, std::string x_label, std::string y_label);
  void add(const Series& series);
  bool empty() const { return series_.empty(); }
  std::string svg() const;

  bool logarithmic_x = false;

 private:
  std::string title_, x_label_, y_label_;
  std::vector<Series> series_;
};

}  // namespace alabaster
