#pragma once

#include <cmath>

#include "core/vec.h"

namespace alabaster {

/// Henyey-Greenstein phase function of mean cosine g in (-1, 1), per steradian; `cosine` is between the
/// directions of travel before and after. Henyey & Greenstein 1941.
inline double henyey_greenstein(double cosine, double g) {
  const double base = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * pi * base * std::sqrt(base));
}

/// The cosine below which a fraction u of the scattered light falls: exact inverse of the distribution.
/// The usual form divides by g; this is the same fraction with that factor cancelled, so that g = 0 and tiny
/// g need no case of their own.
inline double sample_henyey_greenstein(double u, double g) {
  const double s = 2 * u - 1, base = 1 + g * s;
  const double numerator = s + 0.5 * g * ((3 + s * s) + g * (2 * s + g * (s * s - 1)));
  return numerator / (base * base);
}

/// Fraction of the scattered light with a cosine below `cosine`; the inverse of sample_henyey_greenstein.
inline double henyey_greenstein_cdf(double cosine, double g) {
  // (1 - g^2)/(2 g) (1/sqrt(1 + g^2 - 2 g c) - 1/(1 + g)), again without the division by g.
  const double root = std::sqrt(1 + g * g - 2 * g * cosine);
  return (1 - g) * (1 + cosine) / (root * (1 + g + root));
}

}  // namespace alabaster
