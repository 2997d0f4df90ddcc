#include "optics/photon_lanes.h"

#include <cmath>

#include "optics/fast_math.h"

// The loops over lanes are plain C++ without branches, which the compiler turns into vector code
// (CMakeLists.txt compiles this file with -fno-math-errno, or the square root would stay scalar).

namespace alabaster {

namespace {

constexpr int lane_count = 64;
constexpr int vector_width = 8;

// xoshiro128+ (Blackman & Vigna 2018), one state per lane.
struct LaneRng {
  alignas(64) uint32_t s0[lane_count], s1[lane_count], s2[lane_count], s3[lane_count];

  explicit LaneRng(Rng& seeds) {
    for (int i = 0; i < lane_count; ++i) {
      const uint64_t a = mix_bits(seeds.next()), b = mix_bits(seeds.next());
      s0[i] = static_cast<uint32_t>(a), s1[i] = static_cast<uint32_t>(a >> 32);
      s2[i] = static_cast<uint32_t>(b), s3[i] = static_cast<uint32_t>(b >> 32);
    }
  }
  void move(int from, int to) { s0[to] = s0[from], s1[to] = s1[from], s2[to] = s2[from], s3[to] = s3[from]; }

  int32_t next_31_bits(int i) {
    const uint32_t result = s0[i] + s3[i];
    const uint32_t t = s1[i] << 9;
    s2[i] ^= s0[i];
    s3[i] ^= s1[i];
    s1[i] ^= s2[i];
    s0[i] ^= s3[i];
    s2[i] ^= t;
    s3[i] = (s3[i] << 11) | (s3[i] >> 21);
    return static_cast<int32_t>(result >> 1);
  }
  /// Uniform in (0, 1].
  float uniform(int i) { return static_cast<float>(next_31_bits(i)) * 0x1p-31f + 0x1p-32f; }
};

// Cosine and sine of 2 pi u: Taylor series of a quarter of the angle in [-pi/4, pi/4], doubled twice.
inline void circle_point(float u, float& cosine, float& sine) {
  const float a = 1.57079633f * (u - 0.5f), a2 = a * a;
  const float s = a * (1 - a2 * (1.f / 6 - a2 * (1.f / 120 - a2 * (1.f / 5040 - a2 * (1.f / 362880)))));
  const float c = 1 - a2 * (1.f / 2 - a2 * (1.f / 24 - a2 * (1.f / 720 - a2 * (1.f / 40320))));
  const float s_twice = 2 * s * c, c_twice = 1 - 2 * s * s;
  sine = 2 * s_twice * c_twice;
  cosine = 1 - 2 * s_twice * s_twice;
}

class LaneWalk {
 public:
  LaneWalk(const WalkMedium& medium, uint64_t seed, uint64_t stream, uint64_t photons, PathTally& tally)
      : medium_(medium), rng_(seed, stream), lane_rng_(rng_), tally_(tally) {
    for (int stage = 0; stage < WalkStages::count; ++stage)
      to_launch_[stage] = WalkStages::photons(stage, photons);
  }

  void run() {
    while (active_ < lane_count && launch(active_)) ++active_;
    collisions_ = static_cast<uint64_t>(active_);
    while (active_ > 0) {
      const int lanes = (active_ + vector_width - 1) / vector_width * vector_width;
      scatter(lanes);
      fly(lanes);
      settle();
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

  void scatter(int lanes) {
    const auto g = static_cast<float>(medium_.g);
    for (int i = 0; i < lanes; ++i) {
      // sample_henyey_greenstein
      const float s = 2 * lane_rng_.uniform(i) - 1, base = 1 + g * s;
      const float numerator = s + 0.5f * g * ((3 + s * s) + g * (2 * s + g * (s * s - 1)));
      const float cosine = numerator / (base * base);
      const float sine2 = 1 - cosine * cosine;
      const float sine = std::sqrt(sine2 > 0 ? sine2 : 0.f);
      float cos_azimuth, sin_azimuth;
      circle_point(lane_rng_.uniform(i), cos_azimuth, sin_azimuth);
      const float p = sine * cos_azimuth, q = sine * sin_azimuth;
      // Frame(direction).to_world(p, q, cosine)
      const float u = u_[i], v = v_[i], w = w_[i];
      const float sign = w < 0 ? -1.f : 1.f;
      const float a = -1 / (sign + w), b = u * v * a;
      const float nu = p * (1 + sign * u * u * a) + q * b + cosine * u;
      const float nv = p * sign * b + q * (sign + v * v * a) + cosine * v;
      const float nw = -p * sign * u - q * v + cosine * w;
      const float unit = 1.5f - 0.5f * (nu * nu + nv * nv + nw * nw);
      u_[i] = nu * unit;
      v_[i] = nv * unit;
      w_[i] = nw * unit;
    }
  }

  // A free flight, reflected at the boundary: below the critical cosine that is all; above it the lane is
  // marked and left at z < 0 for settle() to decide. By the flight's lack of memory it goes on beyond the
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

  // The rare events: Fresnel decisions, exits, photons stopped at their stage's limit.
  void settle() {
    for (int i = 0; i < active_; ++i) {
      if (!marked_[i]) continue;
      if (!ends(i)) continue;
      while (!launch(i)) {
        // None left: the last lane moves here, and is settled in its turn.
        if (--active_ == i) return;
        move(active_, i);
        if (!marked_[i] || !ends(i)) break;
      }
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

  void move(int from, int to) {
    x_[to] = x_[from], y_[to] = y_[from], z_[to] = z_[from];
    u_[to] = u_[from], v_[to] = v_[from], w_[to] = w_[from];
    order_[to] = order_[from], limit_[to] = limit_[from];
    stage_of_[to] = stage_of_[from], marked_[to] = marked_[from];
    lane_rng_.move(from, to);
  }

  WalkMedium medium_;
  Rng rng_;
  LaneRng lane_rng_;
  PathTally& tally_;
  uint64_t collisions_ = 0;
  uint64_t to_launch_[WalkStages::count];
  int stage_ = WalkStages::count - 1;
  int active_ = 0;
  alignas(64) float x_[lane_count]{}, y_[lane_count]{}, z_[lane_count]{};
  alignas(64) float u_[lane_count]{}, v_[lane_count]{}, w_[lane_count]{};  // direction
  alignas(64) int32_t order_[lane_count]{}, limit_[lane_count]{}, stage_of_[lane_count]{},
      marked_[lane_count]{};
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
