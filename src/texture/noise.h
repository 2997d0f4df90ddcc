#pragma once

#include <cstdint>

#include "core/vec.h"

namespace alabaster {

/// Gradient noise (Perlin 2002's fade, hashed gradients), about [-1, 1], 0 at lattice points, smooth to the
/// second derivative. Deterministic in (p, seed). `period` > 0 repeats it along every axis after that many
/// lattice cells.
double gradient_noise(const Vec3& p, uint64_t seed, int period = 0);

/// Octaves of gradient noise, each of twice the frequency and half the weight, about [-1, 1].
double fractal_noise(const Vec3& p, int octaves, uint64_t seed, int period = 0);

/// Distances to the nearest and the second nearest of points strewn one per lattice cell (Worley 1996), in
/// cells, and a number in [0, 1) that belongs to the nearest.
struct CellularNoise {
  double nearest = 0, second = 0, id = 0;
};
CellularNoise cellular_noise(Vec2 p, uint64_t seed, int period = 0);

}  // namespace alabaster
