#include "optics/fresnel.h"

#include <cmath>

namespace alabaster {

namespace {

// Walsh 1926, "The reflection factor of a polished glass surface for diffused light": the mean of F over a
// cosine-weighted hemisphere outside an index n > 1.
double walsh_diffuse_reflectance(double n) {
  const double n2 = n * n, n4 = n2 * n2;
  const double sum = n2 + 1, difference = n2 - 1;
  return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
         n2 * difference * difference / (sum * sum * sum) * std::log((n - 1) / (n + 1)) -
         2 * n2 * n * (n2 + 2 * n - 1) / (sum * (n4 - 1)) +
         8 * n4 * (n4 + 1) / (sum * (n4 - 1) * (n4 - 1)) * std::log(n);
}

// The closed form cancels badly as n -> 1; there T is close to 1 but for grazing light, so the midpoint rule
// in cos = v^2 is cheap and accurate.
double integrated_transmittance(double n) {
  const int steps = 2000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double v = (i + 0.5) / steps, cosine = v * v;
    sum += (1 - fresnel_dielectric(cosine, n)) * 4 * v * v * v;
  }
  return sum / steps;
}

}  // namespace

double diffuse_transmittance(double eta) {
  if (eta < 1) return diffuse_transmittance(1 / eta) * eta * eta;
  if (eta < 1.05) return integrated_transmittance(eta);
  return 1 - walsh_diffuse_reflectance(eta);
}

}  // namespace alabaster
