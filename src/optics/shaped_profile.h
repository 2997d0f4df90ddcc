#pragma once

#include "optics/profile_table.h"
#include "optics/shape_families.h"

namespace alabaster {

class TabulatedProfile;

/// The basis of one medium with its shape: the half-space's S / alpha in scene units times the factor of the
/// families. What both look up is found once: half the cost of asking one after the other. Where the factor
/// is 1, the half-space's value bit for bit. Immutable and thread-safe.
class ShapedProfile {
 public:
  /// What is passed in outlives this. `sigma_t` in 1/m.
  ShapedProfile(const ProfileTable& half_space, const ShapeFamilies& families, const Rgb& sigma_t);

  /// S(alpha, d; shape) / alpha per channel, 1/m^2.
  Rgb over_albedo(const Rgb& albedo, const PairShape& pair) const;

  const FreePaths& paths() const { return paths_; }

 private:
  Rgb one_by_one(const Rgb& albedo, const PairShape& pair) const;

  const ProfileTable* half_space_;
  const TabulatedProfile* tabulated_;  // the same, if it is one
  const ShapeFamilies* families_;
  FreePaths paths_;
  Rgb sigma_t_, sigma_t_square_;
};

}  // namespace alabaster
