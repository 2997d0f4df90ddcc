#pragma once

#include <cmath>
#include <cstdint>

#include "core/rng.h"

// What the vector walks share: photons in lanes, their random numbers and how they scatter. For files
// compiled with -fno-math-errno only (CMakeLists.txt), or the square root would stay scalar.

namespace alabaster {

inline constexpr int lane_count = 64;
inline constexpr int vector_width = 8;

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

/// Up to lane_count photons, active ones first, in single precision.
struct LaneState {
  LaneState(uint64_t seed, uint64_t stream) : rng_(seed, stream), lane_rng_(rng_) {}

  /// Henyey-Greenstein of mean cosine g in the first `lanes` lanes.
  void scatter(float g, int lanes) {
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

  /// After a flight: replaces each marked photon that `ends(lane)` by the next that `launch(lane)` puts in
  /// its lane. Where none is left to launch the last lane moves in (`move(from, to)`) and is settled in its
  /// turn.
  template <typename Ends, typename Launch, typename Move>
  void settle(const Ends& ends, const Launch& launch, const Move& move) {
    for (int i = 0; i < active_; ++i) {
      if (!marked_[i] || !ends(i)) continue;
      while (!launch(i)) {
        if (--active_ == i) return;
        move(active_, i);
        if (!marked_[i] || !ends(i)) break;
      }
    }
  }

  void move(int from, int to) {
    x_[to] = x_[from], y_[to] = y_[from], z_[to] = z_[from];
    u_[to] = u_[from], v_[to] = v_[from], w_[to] = w_[from];
    order_[to] = order_[from], limit_[to] = limit_[from];
    stage_of_[to] = stage_of_[from], marked_[to] = marked_[from];
    lane_rng_.move(from, to);
  }

  Rng rng_;  // of the rare events
  LaneRng lane_rng_;
  alignas(64) float x_[lane_count]{}, y_[lane_count]{}, z_[lane_count]{};
  alignas(64) float u_[lane_count]{}, v_[lane_count]{}, w_[lane_count]{};  // direction
  alignas(64) int32_t order_[lane_count]{}, limit_[lane_count]{}, stage_of_[lane_count]{},
      marked_[lane_count]{};
  int active_ = 0;
};

}  // namespace alabaster
