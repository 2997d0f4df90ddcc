#pragma once

#include <cstdint>
#include <vector>

#include "optics/order_groups.h"
#include "optics/radial_bins.h"

namespace alabaster {

/// A value with its standard error.
struct Estimate {
  double value = 0;
  double standard_error = 0;
};

/// The orders at which some photons are stopped on purpose. Paths get long (the mean number of collisions up
/// to order N grows as sqrt(N)), so only a part of the photons is followed beyond each stage: unless said
/// otherwise 63 collisions for all, and for half as many each time the limit grows fourfold, to 2^20 - 1.
/// Which photons go on is fixed before they start, whatever their paths.
struct WalkStages {
  static constexpr int count = 9;
  static constexpr int64_t limit(int stage) { return (int64_t{16} << (2 * stage)) - 1; }

  /// log2 of all photons over those that go on after the first stage, which ends with the 15th collision:
  /// what returns at low albedo.
  int first_thinning = 0;
  /// From the end of this stage on a quarter goes on instead of half. Where few leave in any stage, as around
  /// a small cavity, that spends as much on each.
  int quartered_from = count;
  /// Photons still inside after this stage are given up.
  int last = count - 1;

  /// How many of `total` photons are followed into that stage.
  constexpr uint64_t followed(int stage, uint64_t total) const {
    if (stage > last) return 0;
    if (stage == 0) return total;
    const int quartered = stage > quartered_from ? stage - quartered_from : 0;
    return total >> (first_thinning + stage - 1 + quartered);
  }
  /// How many are stopped at its limit.
  constexpr uint64_t photons(int stage, uint64_t total) const {
    return followed(stage, total) - followed(stage + 1, total);
  }
};

/// Exits of the half-space walk by order and by distance or cosine, in integers, so that tallies of parts add
/// up to the same whole in any order.
///
/// Photons stopped at a stage are "censored" in the language of survival analysis: the estimator is that of
/// Kaplan & Meier 1958: the chance to leave in a stage is that among the photons which began it, and the
/// chance to begin it the product over the stages before.
class PathTally {
 public:
  static constexpr int cosine_bins = 32;  // of the outside direction against the normal, equal in cosine

  /// `normal_view`: also holds scores of light leaving along the normal; `far_side`: also exits on the far
  /// side of a slab.
  explicit PathTally(bool normal_view = false, bool far_side = false);

  /// A photon that left after `order` collisions (0: it crossed a finite body without one) at the squared
  /// distance, outside cosine in [0, 1].
  void add_exit(int64_t order, double rho_squared, double cosine_outside) {
    add_exit(exits_, order, rho_squared, cosine_outside);
  }
  /// The same on the far side of a slab, at the squared lateral distance.
  void add_far_exit(int64_t order, double rho_squared, double cosine_outside) {
    add_exit(far_exits_, order, rho_squared, cosine_outside);
  }
  /// A photon still inside after the last collision its stage allows.
  void add_stopped(int stage) { ++stopped_[static_cast<std::size_t>(stage)]; }
  /// One unit of score towards a viewer along the normal, from a collision of that order.
  void add_normal_view(int64_t order, double rho_squared) {
    const auto group = static_cast<std::size_t>(OrderGroups::index(order));
    ++normal_views_[group * RadialBins::count +
                    static_cast<std::size_t>(RadialBins::index_of_square(rho_squared))];
  }
  void add_collisions(uint64_t count) { collisions_ += count; }
  void merge(const PathTally& other);

  uint64_t photons() const;
  uint64_t collisions() const { return collisions_; }
  uint64_t stopped(int stage) const { return stopped_[static_cast<std::size_t>(stage)]; }
  uint64_t exits(int group, int bin) const {
    return exits_[static_cast<std::size_t>(group) * RadialBins::count + static_cast<std::size_t>(bin)];
  }
  bool has_far_side() const { return !far_exits_.empty(); }
  uint64_t far_exits(int group, int bin) const {
    return far_exits_[static_cast<std::size_t>(group) * RadialBins::count + static_cast<std::size_t>(bin)];
  }
  /// Both sides together.
  uint64_t exits_by_cosine(int group, int bin) const {
    return directions_[static_cast<std::size_t>(group) * cosine_bins + static_cast<std::size_t>(bin)];
  }
  bool has_normal_view() const { return !normal_views_.empty(); }
  uint64_t normal_views(int group, int bin) const {
    return normal_views_[static_cast<std::size_t>(group) * RadialBins::count + static_cast<std::size_t>(bin)];
  }
  /// Stage in which an exit of that order group counts. The first is part of the second where no photon was
  /// stopped at its end.
  int stage_of_group(int group) const;
  uint64_t exits_of_stage(int stage) const;

  /// Energy that left, per unit that entered, divided by the albedo: A(alpha)/alpha.
  Estimate reflectance_over_albedo(double albedo) const;
  /// Fraction still inside after 2^20 - 1 collisions: what alpha = 1 is short of 1.
  double truncated() const;

 private:
  void add_exit(std::vector<uint64_t>& exits, int64_t order, double rho_squared, double cosine_outside) {
    const auto group = static_cast<std::size_t>(OrderGroups::index(order));
    ++exits[group * RadialBins::count + static_cast<std::size_t>(RadialBins::index_of_square(rho_squared))];
    const auto bin = static_cast<std::size_t>(cosine_outside * cosine_bins);
    ++directions_[group * cosine_bins + (bin < cosine_bins ? bin : cosine_bins - 1)];
  }

  std::vector<uint64_t> exits_;         // [group][radial bin]
  std::vector<uint64_t> far_exits_;     // the same, or empty
  std::vector<uint64_t> directions_;    // [group][cosine bin]
  std::vector<uint64_t> normal_views_;  // [group][radial bin], or empty
  std::vector<uint64_t> stopped_ = std::vector<uint64_t>(WalkStages::count);
  uint64_t collisions_ = 0;
};

/// The tally read at one albedo: energy per radial bin, per unit that entered, divided by the albedo.
std::vector<Estimate> radial_energy_over_albedo(const PathTally& tally, double albedo);
/// The same for the far side of a slab.
std::vector<Estimate> far_radial_energy_over_albedo(const PathTally& tally, double albedo);

/// The same for light leaving along the normal: of the scores, times `score` each. The errors are those of
/// independent scores; one photon makes several, so they are somewhat too small.
std::vector<Estimate> normal_view_energy_over_albedo(const PathTally& tally, double albedo, double score);

/// Outgoing light by outside cosine at one albedo, as its density over the assumed T(cos) cos 2 / c's.
std::vector<Estimate> exit_lobe_ratio(const PathTally& tally, double albedo, double eta);

}  // namespace alabaster
