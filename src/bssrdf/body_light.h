#pragma once

#include <vector>

#include "bssrdf/distance_table.h"
#include "optics/profile_table.h"
#include "optics/shape_families.h"

namespace alabaster {

/// How much of the light that a point of a curved or thin body sends out crossed the body instead of going
/// around in its skin: what probes aimed at a half-space's profile would find too rarely. Immutable.
class BodyLight {
 public:
  BodyLight(const ProfileTable& profile, const ShapeFamilies& families);

  /// Share of the light in [0, 1), for a level of DistanceTable; `thickness` optical, `sphericity` in [0, 1].
  double share(int level, double thickness, double sphericity) const;

 private:
  static constexpr int sizes =
      26;                      // of the thickness, two to the octave from 2^-2; thicker ones do not count
  std::vector<float> shares_;  // [ball or slab][level][size]
};

}  // namespace alabaster
