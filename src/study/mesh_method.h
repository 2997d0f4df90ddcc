#pragma once

#include <string>
#include <vector>

#include "integrators/surface.h"
#include "study/mesh_scene.h"
#include "study/method_result.h"

namespace alabaster {

/// A way to render meshes, as charts and results.json name it: MODEL+BASIS[+VARIANT][+PLACEMENT]
/// [+DISTANCE] (composite+half-space, composite+half-space+symmetric, composite+shape+view+straightest,
/// homogeneous+shape+geodesic), `walk` (random walks with the exit's albedo) or `volume`. Neither the default
/// placement nor the chord is named.
struct MeshMethod {
  std::string name;  // in full
  Transport transport = Transport::bssrdf;
  std::string model;  // of Transport::bssrdf, for make_bssrdf()
  std::string basis;
  std::string placement = "chord";  // of its kernel, for make_placement()
  std::string distance = "chord";   // of its basis, for make_surface_distance()

  Basis basis_value() const;
  SurfaceOptions apply(SurfaceOptions options) const;
};

/// The bases that models can stand on; the first is the default.
const std::vector<std::string>& mesh_bases();

/// Parses a name; MODEL[:VARIANT] alone stands on the default basis. Throws InputError.
MeshMethod parse_mesh_method(const std::string& name);
/// Every model on every basis, composite+shape+view, then the walk.
std::vector<MeshMethod> standard_mesh_methods();

/// The method's image at `spp` Sobol samples per pixel.
TimedImage render_mesh(const MeshScene& scene, const MeshMethod& method, uint32_t spp, uint64_t seed);
/// The same with an integrator that stands already.
TimedImage render_timed(const SurfaceIntegrator& integrator, const std::string& label, uint32_t spp,
                        uint64_t seed);

}  // namespace alabaster
