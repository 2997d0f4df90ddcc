#pragma once

#include <string>
#include <vector>

#include "report/chart.h"
#include "study/planar_method.h"

namespace alabaster {

// Figures of the flat laboratory that need no image: speed, and the energy of eq. 2.

/// Evaluations of S_V per CPU second of one thread, the entry's albedo lookup included, over pairs as an
/// image has them, measured for `seconds`.
double evaluations_per_second(const PlanarModel& model, double seconds = 0.2);

struct PlanarSpeed {
  std::string scene;
  std::vector<std::pair<std::string, double>> evaluations;   // by model, per second and core
  std::vector<std::pair<std::string, double>> seconds_to_2;  // CPU s to 2 % noise, by way of sampling
  /// Of the volumetric reference, every photon walking by itself, and (0 where it has none) on the lattice.
  double reference_seconds_to_2 = 0, lattice_seconds_to_2 = 0;
};

/// What every model costs on a scene, and the ways of sampling that [EK17] compares: (a) uniform over the
/// light, (b) by the profile, (c) both, and the default.
PlanarSpeed measure_planar_speed(const PlanarScene& scene, const ProfileTable& profile, uint64_t seed);

/// The energy that eq. 2 returns from a point where entry and exit have one albedo and what lies between has
/// another: (alpha_i alpha_e / alpha_t^2) A(alpha_t) over A(alpha_i). Above 1 it exceeds what a medium as
/// bright as both ends everywhere would return. `order1_apart`: the variant that bounds it.
double energy_ratio(const ProfileTable& profile, double local, double between, bool order1_apart);
/// energy_ratio() over alpha_t for some local albedos.
Chart energy_chart(const ProfileTable& profile);

/// How often and by how much a model exceeds the basis at the scene's largest albedo, which no medium of that
/// texture can: over pairs whose distances follow the profile.
struct EnergyExcess {
  double share = 0;  // of the pairs
  double mean = 0;   // of S_V over the bound, where exceeded
  double worst = 0;
};
EnergyExcess energy_excess(const PlanarModel& model, const ProfileTable& profile, uint64_t seed);

}  // namespace alabaster
