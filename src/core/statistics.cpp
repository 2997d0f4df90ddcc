#include "core/statistics.h"

namespace alabaster {

double two_sided_normal_p_value(double z) {
  return std::erfc(std::abs(z) / std::sqrt(2.0));
}

namespace {

// Regularised incomplete gamma functions after Abramowitz & Stegun 6.5.29 (series) and 6.5.31 (continued
// fraction, evaluated by Lentz's method).
double lower_gamma_series(double a, double x) {
  double term = 1.0 / a, sum = term;
  for (int n = 1; n < 10000 && term > sum * 1e-16; ++n) sum += term *= x / (a + n);
  return sum * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

double upper_gamma_fraction(double a, double x) {
  const double tiny = 1e-300;
  double b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
  for (int i = 1; i < 10000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (std::abs(an * d + b) < tiny ? tiny : an * d + b);
    c = std::abs(b + an / c) < tiny ? tiny : b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return h * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

}  // namespace

double chi_square_p_value(double statistic, double degrees_of_freedom) {
  if (statistic <= 0) return 1;
  const double a = degrees_of_freedom / 2, x = statistic / 2;
  return x < a + 1 ? 1 - lower_gamma_series(a, x) : upper_gamma_fraction(a, x);
}

double sidak(double alpha, double tests) {
  return -std::expm1(std::log1p(-alpha) / tests);
}

}  // namespace alabaster
