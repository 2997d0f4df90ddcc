#include "optics/monotone_curve.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace alabaster {

MonotoneCurve::MonotoneCurve(std::vector<double> values)
    : values_(std::move(values)), slopes_(values_.size()) {
  assert(values_.size() >= 2);
  const std::size_t last = values_.size() - 1;
  const auto secant = [&](std::size_t i) { return values_[i + 1] - values_[i]; };
  for (std::size_t i = 1; i < last; ++i) {
    const double before = secant(i - 1), after = secant(i);
    slopes_[i] = before * after > 0 ? 2 * before * after / (before + after) : 0;
  }
  // At the ends the parabola through three points, as far as it keeps the curve monotone.
  const auto end_slope = [](double near, double next) {
    const double slope = 1.5 * near - 0.5 * next;
    if (slope * near <= 0) return 0.0;
    return near * next <= 0 || slope / near > 3 ? 3 * near : slope;
  };
  slopes_[0] = last == 1 ? secant(0) : end_slope(secant(0), secant(1));
  slopes_[last] = last == 1 ? secant(0) : end_slope(secant(last - 1), secant(last - 2));
}

double MonotoneCurve::segment(std::size_t i, double t) const {
  const double s = 1 - t;
  return values_[i] * (1 + 2 * t) * s * s + slopes_[i] * t * s * s + values_[i + 1] * t * t * (3 - 2 * t) -
         slopes_[i + 1] * t * t * s;
}

double MonotoneCurve::operator()(double x) const {
  const auto last = static_cast<double>(values_.size() - 1);
  x = std::clamp(x, 0.0, last);
  const auto i = std::min(static_cast<std::size_t>(x), values_.size() - 2);
  return segment(i, x - static_cast<double>(i));
}

double MonotoneCurve::inverse(double value) const {
  const bool rises = values_.back() > values_.front();
  const auto before = [rises](double a, double b) { return rises ? a < b : a > b; };
  if (!before(values_.front(), value)) return 0;
  const auto above = std::lower_bound(values_.begin(), values_.end(), value, before);
  if (above == values_.end()) return static_cast<double>(values_.size() - 1);
  const auto i = static_cast<std::size_t>(above - values_.begin()) - 1;
  double low = 0, high = 1;
  for (int step = 0; step < 60 && high - low > 1e-15; ++step) {
    const double middle = 0.5 * (low + high);
    (before(segment(i, middle), value) ? low : high) = middle;
  }
  return static_cast<double>(i) + 0.5 * (low + high);
}

}  // namespace alabaster
