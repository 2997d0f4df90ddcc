#include "study/image_errors.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>

namespace alabaster {

namespace {

/// Visits every pixel and channel as (a, variance of a, b, variance of b).
template <class Visit>
void for_each_value(const Image& a, const Image& b, Visit visit) {
  assert(a.width() == b.width() && a.height() == b.height());
  for (const char* name : {"R", "G", "B"}) {
    const std::string variance = std::string("variance.") + name;
    const int ca = a.find(name), cb = b.find(name), va = a.find(variance), vb = b.find(variance);
    assert(ca >= 0 && cb >= 0 && va >= 0 && vb >= 0);
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x)
        visit(static_cast<double>(a.at(ca, x, y)), static_cast<double>(a.at(va, x, y)),
              static_cast<double>(b.at(cb, x, y)), static_cast<double>(b.at(vb, x, y)));
  }
}

// Grey images repeat one channel three times: what was independent is a third as much.
double independent_values(const Image& image) {
  const auto pixels = static_cast<double>(image.width()) * image.height();
  const int r = image.find("R"), g = image.find("G"), b = image.find("B");
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (image.at(r, x, y) != image.at(g, x, y) || image.at(g, x, y) != image.at(b, x, y)) return 3 * pixels;
  return pixels;
}

struct LogRatios {
  double sum = 0, variance = 0, count = 0;  // over all pixels the reference knows well enough
  double used = 0, eligible = 0;            // of those above 1e-4 of the maximum
};

LogRatios log_ratios(const Image& a, const Image& b, double maximum) {
  LogRatios result;
  const double cap = std::log(1000.0);
  for_each_value(a, b, [&](double va, double var_a, double vb, double var_b) {
    const bool eligible = vb > 1e-4 * maximum;
    if (eligible) result.eligible += 1;
    if (!(vb > 10 * std::sqrt(var_b)) || !(vb > 0)) return;
    if (eligible) result.used += 1;
    const double ratio = va > 0 ? std::min(std::abs(std::log(va / vb)), cap) : cap;
    result.sum += ratio;
    result.count += 1;
    result.variance += (va > 0 ? var_a / (va * va) : 0) + var_b / (vb * vb);
  });
  return result;
}

}  // namespace

ImageErrors image_errors(const Image& a, const Image& reference) {
  double difference = 0, square = 0, variance = 0, spread = 0, sum_a = 0, sum_b = 0, maximum = 0, count = 0;
  for_each_value(a, reference, [&](double va, double var_a, double vb, double var_b) {
    const double d = va - vb, v = var_a + var_b;
    difference += d * d;
    square += vb * vb;
    variance += v;
    // Variance of d^2 where d is normal around its mean: 4 mean^2 v + 2 v^2, mean^2 estimated by d^2 - v.
    spread += std::max(0.0, 4 * d * d * v - 2 * v * v);
    sum_a += va;
    sum_b += vb;
    maximum = std::max(maximum, vb);
    count += 1;
  });
  ImageErrors e;
  if (!(square > 0)) return e;
  const double repeats = count / independent_values(a);
  e.rmse_over_rms = std::sqrt(difference / square);
  const double x = (difference - variance) / square;
  e.bias = std::copysign(std::sqrt(std::abs(x)), x);
  e.noise = std::sqrt(variance / square);
  e.mean_bias = sum_a / sum_b - 1;
  const double x_interval = 1.96 * std::sqrt(repeats * spread) / square;
  // d sqrt(x) = dx / (2 sqrt(x)), but no more than sqrt(dx) where x is lost in it.
  e.bias_interval = std::min(x_interval / (2 * std::max(std::abs(e.bias), 1e-12)), std::sqrt(x_interval));
  e.mean_bias_interval = 1.96 * std::sqrt(repeats * variance) / sum_b;
  const LogRatios logs = log_ratios(a, reference, maximum);
  if (logs.eligible > 0) e.kept = logs.used / logs.eligible;
  if (logs.count > 0) {
    e.mean_abs_log_ratio = logs.sum / logs.count;
    e.log_interval = 1.96 * std::sqrt(repeats * logs.variance) / logs.count;
  }
  return e;
}

}  // namespace alabaster
