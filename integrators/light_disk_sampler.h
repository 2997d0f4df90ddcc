#pragma once

#include <optional>
#include <vector>

#include "bssrdf/distance_table.h"
#include "core/vec.h"

namespace alabaster {

/// Draws entry points within a lit disk for an exit on the same plane, in proportion to a profile: first the
/// direction, by the share of the profile that lies along it inside the disk, then the distance, from the
/// profile confined to that chord. No sample misses, and on a constant texture all weigh nearly the same.
/// The shares are tabulated over the exit's distance from the centre; positive wherever the disk is.
/// Immutable and thread-safe.
class LightDiskSampler {
 public:
  /// `sigma_t` in 1/m, `radius` in m; `distances` must outlive this.
  LightDiskSampler(const DistanceTable& distances, double sigma_t, double radius);

  /// The disk as an exit sees it.
  struct View {
    Vec2 towards{1, 0};    // unit, to the centre
    double offset = 0;     // m, from the centre
    double widest = pi;    // half the angle under which the disk lies
    std::size_t node = 0;  // of the tables
  };
  View view(Vec2 exit_to_centre) const;

  /// A place in polar coordinates around the exit, with the chord it lies on.
  struct Place {
    double angle = 0;                  // to the direction of the centre, signed
    Vec2 direction{1, 0};              // its cosine and sine
    double distance = 0;               // m, > 0
    double nearest = 0, farthest = 0;  // m, where the chord enters and leaves the disk
  };
  /// The place of a displacement from the exit; none outside the disk (or at the exit itself).
  std::optional<Place> place(const View& view, Vec2 displacement) const;
  Vec2 displacement(const View& view, const Place& place) const;

  /// `level` of the distance table. Nothing where the chord drawn has no length.
  std::optional<Place> sample(const View& view, int level, Vec2 u) const;
  /// Per m^2.
  double pdf(const View& view, int level, const Place& place) const;

  /// Whether the profile varies so little over the disk, or so little of it lies there, that points uniform
  /// by area serve better.
  bool is_even(const View& view, int level) const { return even_[index(view.node, level)]; }

 private:
  static std::size_t index(std::size_t node, int level) {
    return node * DistanceTable::level_count + static_cast<std::size_t>(level);
  }
  Place chord(const View& view, double angle, Vec2 direction) const;
  void tabulate(std::size_t node, int level);
  double offset_of_node(std::size_t node) const;  // in radii

  const DistanceTable& distances_;
  double sigma_t_, radius_;
  std::vector<float> cumulative_;  // node x level x bins + 1, over the angle
  std::vector<bool> even_;         // node x level
};

}  // namespace alabaster
