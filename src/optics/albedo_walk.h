#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "optics/path_tally.h"
#include "optics/photon_walk.h"

namespace alabaster {

/// How light arrives: along the normal, uniform from the whole hemisphere, or at a given cosine to the
/// normal.
enum class EntryKind { normal, diffuse, direction };

struct AlbedoWalkOptions {
  WalkMedium medium;
  double albedo = 0.9;  // [0, 1]
  EntryKind entry = EntryKind::diffuse;
  double entry_cosine = 1;          // outside, for EntryKind::direction; (0, 1]
  std::optional<double> thickness;  // optical; none: half-space
  uint64_t photons = 1000000;       // that entered
  uint64_t seed = 1;
};

/// The analog walk of [EK17] section 3 at one albedo: at each collision the photon goes on with probability
/// alpha. Every photon ends in exactly one of the counts. It is the oracle of the order-resolved walk, and
/// what `alabaster profile` runs.
struct AlbedoWalkResult {
  uint64_t photons = 0;                // that entered
  uint64_t reflected_unscattered = 0;  // came back without a collision (slabs)
  uint64_t reflected = 0;              // came back after at least one
  uint64_t transmitted = 0;            // left on the far side, scattered or not
  uint64_t absorbed = 0;               // counted at the collision
  uint64_t truncated = 0;              // still inside after 2^20 - 1 collisions
  uint64_t collisions = 0;
  std::vector<uint64_t> exits = std::vector<uint64_t>(RadialBins::count);  // of `reflected`, by distance
  double specular = 0;  // fraction of the incident light that the outer surface reflects at once

  /// Fractions of the incident light.
  Estimate reflectance() const { return of_incident(reflected + reflected_unscattered); }
  Estimate transmittance() const { return of_incident(transmitted); }
  Estimate absorbed_fraction() const { return of_incident(absorbed); }
  Estimate truncated_fraction() const { return of_incident(truncated); }
  Estimate total_reflectance() const;
  /// A: of the light that entered and of the bins, per unit that entered.
  Estimate of_entered(uint64_t count) const;
  std::vector<Estimate> radial_energy() const;

  void merge(const AlbedoWalkResult& other);

 private:
  Estimate of_incident(uint64_t count) const;
};

/// Depends on the options alone, not on the number of threads.
AlbedoWalkResult walk_at_albedo(const AlbedoWalkOptions& options);

}  // namespace alabaster
