#include "optics/photon_lanes.h"

#include <cmath>

#include "optics/fast_math.h"
#include "optics/lane_state.h"

// The loops over lanes are plain C++ without branches, which the compiler turns into vector code
// (CMakeLists.txt compiles this file with -fno-math-errno, or the square root would stay scalar).

namespace alabaster {

namespace {

class LaneWalk : LaneState {
 public:
  LaneWalk(const WalkMedium& medium, uint64_t seed, uint64_t stream, uint64_t photons, PathTally& tally)
      : LaneState(seed, stream), medium_(medium), tally_(tally) {
    for (int stage = 0; stage < WalkStages::count; ++stage)
      to_launch_[stage] = WalkStages().photons(stage, photons);
  }

  void run() {
    while (active_ < lane_count && launch(active_)) ++active_;
    collisions_ = static_cast<uint64_t>(active_);
    while (active_ > 0) {
      const int lanes = (active_ + vector_width - 1) / vector_width * vector_width;
      scatter(static_cast<float>(medium_.g), lanes);
      fly(lanes);
      settle([this](int i) { return ends(i); }, [this](int i) { return launch(i); },
             [this](int from, int to) { move(from, to); });
      if (tally_.has_normal_view()) look_up();
      collisions_ += static_cast<uint64_t>(active_);
    }
    tally_.add_collisions(collisions_);
  }

 private:
  // Puts the next photon at its first collision; the longest stages first, so that a few long walks do
  // not trail after all others have ended. False when none is left.
  bool launch(int lane) {
    while (stage_ >= 0 && to_launch_[stage_] == 0) --stage_;
    if (stage_ < 0) return false;
    --to_launch_[stage_];
    const Vec3 direction = sample_diffuse_entry(medium_.eta, rng_);
    const Vec3 position = sample_free_flight(rng_) * direction;
    x_[lane] = static_cast<float>(position.x);
    y_[lane] = static_cast<float>(position.y);
    z_[lane] = static_cast<float>(position.z);
    u_[lane] = static_cast<float>(direction.x);
    v_[lane] = static_cast<float>(direction.y);
    w_[lane] = static_cast<float>(direction.z);
    order_[lane] = 1;
    limit_[lane] = static_cast<int32_t>(WalkStages::limit(stage_));
    stage_of_[lane] = stage_;
    return true;
  }

  // A free flight, reflected at the boundary: below the critical cosine that is all; above it the lane is
  // marked and left at z < 0 for ends() to decide. By the flight's lack of memory it goes on beyond the
  // reflection.
  void fly(int lanes) {
    const auto critical = static_cast<float>(std::sqrt(1 - 1 / (medium_.eta * medium_.eta)));
    for (int i = 0; i < lanes; ++i) {
      const float flight = -fast_log(lane_rng_.uniform(i));
      const float z = z_[i] + flight * w_[i], w = w_[i];
      x_[i] += flight * u_[i];
      y_[i] += flight * v_[i];
      const bool crosses = z < 0, may_leave = crosses & (-w >= critical), mirrored = crosses & !may_leave;
      z_[i] = mirrored ? -z : z;
      w_[i] = mirrored ? -w : w;
      order_[i] += 1;
      marked_[i] = static_cast<int32_t>(may_leave) | static_cast<int32_t>(order_[i] > limit_[i]);
    }
  }

  // From each collision a virtual turn to the normal, accepted in proportion to the phase function, and a
  // virtual flight up, which must reach the surface.
  void look_up() {
    const auto g = static_cast<float>(medium_.g);
    const float peak = 1 - std::abs(g);  // (1 + g^2 - 2 |g|)^(1/2)
    const int lanes = (active_ + vector_width - 1) / vector_width * vector_width;
    for (int i = 0; i < lanes; ++i) {
      const float root = std::sqrt(1 + g * g + 2 * g * w_[i]);  // the cosine to the normal is -w
      const float ratio = peak / root;
      const float accepted = ratio * ratio * ratio;
      const float flight = -fast_log(lane_rng_.uniform(i));
      marked_[i] =
          static_cast<int32_t>(flight > z_[i]) & static_cast<int32_t>(lane_rng_.uniform(i) <= accepted);
    }
    for (int i = 0; i < active_; ++i)
      if (marked_[i]) tally_.add_normal_view(order_[i], double{x_[i]} * x_[i] + double{y_[i]} * y_[i]);
  }

  // The rare events: Fresnel decisions, exits, photons stopped at their stage's limit.
  bool ends(int i) {
    if (z_[i] < 0) {
      const double cosine = -static_cast<double>(w_[i]);
      if (!reflected_inside(std::min(cosine, 1.0), medium_.eta, rng_)) {
        // The part of the flight beyond the surface is taken back.
        const double beyond = -static_cast<double>(z_[i]) / cosine;
        const double x = x_[i] - beyond * u_[i], y = y_[i] - beyond * v_[i];
        tally_.add_exit(order_[i] - 1, x * x + y * y, refracted_cosine(cosine, 1 / medium_.eta));
        return true;
      }
      z_[i] = -z_[i];
      w_[i] = -w_[i];
    }
    if (order_[i] <= limit_[i]) return false;
    tally_.add_stopped(stage_of_[i]);
    return true;
  }

  WalkMedium medium_;
  PathTally& tally_;
  uint64_t collisions_ = 0;
  uint64_t to_launch_[WalkStages::count];
  int stage_ = WalkStages::count - 1;
};

}  // namespace

double normal_view_score(const WalkMedium& medium) {
  // Radiance outside per unit of scattered light: p exp(-z) T(1) / eta^2; times pi c / T(1).
  const double strongest = henyey_greenstein(medium.g < 0 ? -1 : 1, medium.g);
  return pi * diffuse_transmittance(medium.eta) * strongest / (medium.eta * medium.eta);
}

void walk_in_lanes(const WalkMedium& medium, uint64_t seed, uint64_t stream, uint64_t photons,
                   PathTally& tally) {
  LaneWalk(medium, seed, stream, photons, tally).run();
}

}  // namespace alabaster
