#pragma once

// What a walk carries along: shared by volume_walk.cpp and light_search.cpp, of no use elsewhere.

#include <cmath>
#include <limits>

#include "integrators/volume_walk.h"

namespace alabaster {

/// A collision, seen as a place to look for light from.
struct VolumeWalk::Vertex {
  Vec3 position{0};
  Vec3 direction{0};       // of travel before the collision
  Vec3 normal{0};          // of the surface nearby, outwards
  double depth = 0;        // m, about
  double probability = 0;  // that light is looked for; a function of the place alone
  Rgb weight;              // of the path, this collision's albedo in it
  const DepthGuide* guide = nullptr;
};

/// A straight way from a collision to the outside.
struct VolumeWalk::Crossing {
  Vec3 inside{0}, outside{0};  // unit, directions of travel
  SurfacePoint point;
  double distance = 0;  // m, inside
};

/// One of the ways out that a walk found, kept in proportion to what it promises.
struct VolumeWalk::Candidate {
  Vertex vertex;
  Vec3 outside{0};
  double pdf = 0;
  double promise = 0;
  int64_t order = 0;
};

struct VolumeWalk::State {
  const DepthGuides::Column* guides = nullptr;  // null: nothing steers the walk
  const DepthGuide* guide = nullptr;  // of the last collision or reflection; null: as if nothing did
  SteeredFlight flight;               // the one to come
  Vec3 position{0}, direction{0};
  uint32_t triangle = no_index;  // the boundary triangle the ray starts on; no_index at a collision
  Rgb weight{1};
  Rgb exit_albedo;
  int64_t order = 0;
  double clearance = 0;                                    // m: no boundary is closer to `position`
  double reach = std::numeric_limits<double>::infinity();  // m: some boundary is at most this close
  Vec3 normal{0};                                          // of the surface near the last collision
  double depth = 0;                                        // m, of the last collision, about
  bool left = false;
  SurfacePoint end;
  Vec3 end_inside{0};         // direction of travel before the exit
  double end_distance = 0;    // m, of the last flight
  bool end_reflected = true;  // the last flight began at the boundary, not at a collision
  Vertex vertex;              // the last collision
  Candidate candidate;
  double promised = 0;  // by all candidates
  int64_t queries = 0, rays = 0, lost = 0;
};

/// Corrections of cached albedos may leave a weight negative.
inline Rgb magnitude(const Rgb& weight) {
  return {std::abs(weight.r), std::abs(weight.g), std::abs(weight.b)};
}

inline Rgb attenuation(const Rgb& sigma_t, double distance) {
  return {std::exp(-sigma_t.r * distance), std::exp(-sigma_t.g * distance), std::exp(-sigma_t.b * distance)};
}

/// Density of the flights that the mixture of channels draws, where each has the density given; the shares
/// are those of the weights.
inline double mixture(const Rgb& weight, const Rgb& density) {
  const Rgb share = magnitude(weight), shared = share * density;
  return (shared.r + shared.g + shared.b) / (share.r + share.g + share.b);
}

}  // namespace alabaster
