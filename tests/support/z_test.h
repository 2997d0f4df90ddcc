#pragma once

#include <cmath>
#include <string>

#include "core/statistics.h"
#include "image/image.h"

/// Two-sided p-value of a Student t statistic, by the normal that is close to it from a few degrees of
/// freedom on (Wallace 1959, eq. 2).
inline double student_p_value(double t, double degrees_of_freedom) {
  const double v = degrees_of_freedom;
  const double z = (8 * v + 1) / (8 * v + 3) * std::sqrt(v * std::log1p(t * t / v));
  return alabaster::two_sided_normal_p_value(z);
}

struct ZTest {
  double smallest_p = 1;  // over pixels and channels
  int tests = 0;
  double mean_square = 0;  // of the t statistics, about 1 when variances are right
  std::string where;       // of the smallest
  /// All pixels together at significance `alpha` (Sidak).
  bool passes(double alpha = 1e-3) const { return tests > 0 && smallest_p > alabaster::sidak(alpha, tests); }
};

/// Whether the R, G, B of two independent images with variance.* channels agree, each variance from that many
/// degrees of freedom. Pixels without variance in both must be equal.
inline ZTest z_test(const alabaster::Image& a, const alabaster::Image& b, double degrees_of_freedom) {
  ZTest result;
  for (int c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    const int va = a.find("variance." + name), vb = b.find("variance." + name);
    const int ca = a.find(name), cb = b.find(name);
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x) {
        const double difference = static_cast<double>(a.at(ca, x, y)) - b.at(cb, x, y);
        const double variance = static_cast<double>(a.at(va, x, y)) + b.at(vb, x, y);
        if (variance == 0 && difference == 0) continue;
        const double t = variance > 0 ? difference / std::sqrt(variance) : 1e9;
        const double p = student_p_value(t, degrees_of_freedom);
        ++result.tests;
        result.mean_square += t * t;
        if (p < result.smallest_p) {
          result.smallest_p = p;
          result.where =
              name + " at (" + std::to_string(x) + ", " + std::to_string(y) + "), t = " + std::to_string(t);
        }
      }
  }
  if (result.tests > 0) result.mean_square /= result.tests;
  return result;
}
