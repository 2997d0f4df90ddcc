#include "scene/medium.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

double albedo_from_multiscatter(double colour, double g) {
  // The fit of Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks"; g by similarity.
  const double c = std::clamp(colour, 0.0, 1.0);
  const double s = 4.09712 + 4.20863 * c - std::sqrt(9.59217 + 41.6808 * c + 17.7126 * c * c);
  return std::clamp((1 - s * s) / (1 - g * s * s), 0.0, 1.0);
}

}  // namespace alabaster
