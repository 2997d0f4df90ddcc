#include "study/report_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/false_colour.h"
#include "image/png_file.h"

namespace alabaster {

double white_level(const Image& image) {
  std::vector<float> values;
  for (int c = 0; c < 3; ++c)
    values.insert(values.end(), image.plane(c), image.plane(c) + image.width() * image.height());
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 995 / 1000);
  std::nth_element(values.begin(), place, values.end());
  return std::max(static_cast<double>(*place), 1e-30);
}

ReportImage picture(const Image& image, double white, const std::string& label, const std::string& alt) {
  Image colour(image.width(), image.height(), {"R", "G", "B"});
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) colour.set_rgb(0, x, y, image.rgb(0, x, y));
  return {display_pixels(colour, -std::log2(white)), label, alt};
}

ReportImage difference_picture(const Image& a, const Image& b, double white, const std::string& label,
                               const std::string& alt) {
  ColourScale scale;
  scale.high = 0.5 * white;
  scale.is_signed = true;
  const ColourChannels plain = *find_layer(a, "");
  return {false_colour(signed_difference(a, plain, b, *find_layer(b, "")), a.width(), a.height(), scale),
          label, alt};
}

std::string percent(double fraction) {
  return fmt::format("{:+.1f} %", 100 * fraction);
}

std::string with_interval(double value, double interval) {
  return fmt::format("{:.3f} ± {:.3f}", value, interval);
}

std::string percent_with_interval(double value, double interval) {
  return fmt::format("{:+.1f} ± {:.1f} %", 100 * value, 100 * interval);
}

std::string log_ratio_text(const Metrics& metrics) {
  std::string text = with_interval(metrics.mean_abs_log_ratio, metrics.log_interval.value_or(0));
  if (metrics.kept < 0.95) text += fmt::format(" (only {:.0f} % of pixels)", 100 * metrics.kept);
  return text;
}

std::size_t best_column(const std::vector<double>& values, std::size_t first_column) {
  if (values.empty()) return 0;
  return first_column +
         static_cast<std::size_t>(std::min_element(values.begin(), values.end()) - values.begin());
}

}  // namespace alabaster
