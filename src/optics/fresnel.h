#pragma once

namespace alabaster {

/// Fresnel reflectance of a smooth dielectric for unpolarised light. `cos_incident` >= 0 is measured on the
/// side the light comes from; `eta` = index behind the surface / index of the side it comes from. 1 on total
/// reflection.
double fresnel_dielectric(double cos_incident, double eta);

/// The integral of (1 - F(cos)) cos / pi over the hemisphere outside: c of DESIGN section 1, 0.9082 at eta
/// = 1.5. By reciprocity also what normalises the outgoing lobe T(cos)/(pi c).
double diffuse_transmittance(double eta);

}  // namespace alabaster
