#pragma once

#include <string>
#include <vector>

#include "image/image.h"
#include "image/metrics.h"
#include "report/html_report.h"

namespace alabaster {

// What the reports of all studies show in the same way.

/// What is shown as white: the value that one in two hundred exceeds.
double white_level(const Image& image);
/// The picture with `white` as its brightest.
ReportImage picture(const Image& image, double white, const std::string& label, const std::string& alt);
/// a - b in blue (darker) and red (brighter), full colour at half of `white`.
ReportImage difference_picture(const Image& a, const Image& b, double white, const std::string& label,
                               const std::string& alt);

std::string percent(double fraction);                      // "+1.5 %"
std::string with_interval(double value, double interval);  // "0.123 ± 0.004"
std::string percent_with_interval(double value, double interval);
/// The mean absolute log ratio, with a remark where it is known for too few pixels to be used.
std::string log_ratio_text(const Metrics& metrics);

/// The reasons, in their member `skipped`, why some of the scenes are not in the report.
template <typename Scenes>
void list_left_out(HtmlReport& report, const Scenes& scenes) {
  std::vector<std::string> reasons;
  for (const auto& scene : scenes)
    if (!scene.skipped.empty()) reasons.push_back("Left out: " + scene.skipped);
  if (!reasons.empty()) report.list(reasons);
}

/// The column (from 1) of a table's row with the least value.
std::size_t best_column(const std::vector<double>& values, std::size_t first_column);

}  // namespace alabaster
