#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bssrdf/bssrdf.h"
#include "integrators/planar.h"
#include "study/method_result.h"

namespace alabaster {

/// A model with everything that decides its image of a flat scene, as charts and results.json name it:
/// MODEL[:VARIANT...], the variants composite:symmetric, composite:order1, composite:view; aggregate:WIDTH
/// and aggregate:WIDTH:mcSAMPLES (the ellipse's width, Monte Carlo as in the paper instead of pyramid
/// lookups); and :uniform, :profile, :mis for other than the default sampling.
struct PlanarMethod {
  std::string name;   // as given
  std::string model;  // for make_bssrdf()
  BssrdfOptions options;
  PlanarSampling sampling = PlanarSampling::clipped;
};

/// Throws InputError for a name that is none.
PlanarMethod parse_planar_method(const std::string& name);

/// The method's image at `spp` Sobol samples per pixel.
TimedImage render_planar(const PlanarScene& scene, const PlanarMethod& method, const ProfileTable& profile,
                         uint32_t spp, uint64_t seed);

/// The volumetric reference until its noise() is at most `noise` and at least the share `known` of the pixels
/// above 1e-4 of the maximum exceeds ten standard errors (Metrics::kept: what the log ratio needs), or
/// `max_paths` (on the lattice a hundred times as many, which cost the same) are spent; by
/// cheapest_estimator().
TimedImage render_planar_reference(const PlanarScene& scene, double noise, double known, uint64_t max_paths,
                                   uint64_t seed);

}  // namespace alabaster
