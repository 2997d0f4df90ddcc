#pragma once

#include <algorithm>
#include <cmath>

namespace alabaster {

/// Fresnel reflectance of a smooth dielectric for unpolarised light. `cos_incident` >= 0 is measured on the
/// side the light comes from; `eta` = index behind the surface / index of the side it comes from. 1 on total
/// reflection.
inline double fresnel_dielectric(double cos_incident, double eta) {
  if (eta == 1) return 0;
  const double sin2_transmitted = (1 - cos_incident * cos_incident) / (eta * eta);
  if (sin2_transmitted >= 1) return 1;
  const double cos_transmitted = std::sqrt(1 - sin2_transmitted);
  const double parallel = (eta * cos_incident - cos_transmitted) / (eta * cos_incident + cos_transmitted);
  const double perpendicular =
      (cos_incident - eta * cos_transmitted) / (cos_incident + eta * cos_transmitted);
  return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

/// Cosine behind the surface of the refracted ray; `eta` as above. 0 on total reflection.
inline double refracted_cosine(double cos_incident, double eta) {
  return std::sqrt(std::max(0.0, 1 - (1 - cos_incident * cos_incident) / (eta * eta)));
}

/// The integral of (1 - F(cos)) cos / pi over the hemisphere outside: c of docs/optics.md, 0.9082 at eta
/// = 1.5. By reciprocity also what normalises the outgoing lobe T(cos)/(pi c). Below 1 (light inside):
/// c(1/eta) eta^2.
double diffuse_transmittance(double eta);

}  // namespace alabaster
