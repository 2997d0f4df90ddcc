#include "texture/noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/rng.h"

namespace alabaster {

namespace {

int64_t wrap_cell(int64_t i, int period) {
  return period > 0 ? ((i % period) + period) % period : i;
}

uint64_t hash_cell(int64_t x, int64_t y, int64_t z, uint64_t seed) {
  // 21 bits of each coordinate side by side: lattices of a million cells, hashed in one round.
  const auto low_bits = [](int64_t i) { return static_cast<uint64_t>(i) & 0x1fffff; };
  return hash_combine(seed, low_bits(x) | low_bits(y) << 21 | low_bits(z) << 42);
}

double to_unit(uint64_t hash) {
  return static_cast<double>(hash >> 11) * 0x1p-53;
}

/// 256 unit gradients, even over the sphere (a Fibonacci spiral).
const Vec3& cell_gradient(uint64_t hash) {
  static const std::array<Vec3, 256> directions = [] {
    std::array<Vec3, 256> result;
    for (std::size_t k = 0; k < result.size(); ++k) {
      const double z = 1 - (2 * static_cast<double>(k) + 1) / 256, r = std::sqrt(1 - z * z);
      const double phi = static_cast<double>(k) * pi * (3 - std::sqrt(5.0));
      result[k] = {r * std::cos(phi), r * std::sin(phi), z};
    }
    return result;
  }();
  return directions[hash >> 56];
}

}  // namespace

double gradient_noise(const Vec3& p, uint64_t seed, int period) {
  const Vec3 cell = glm::floor(p), f = p - cell;
  const Vec3 fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 offset(corner & 1, (corner >> 1) & 1, corner >> 2);
    const Vec3 lattice = cell + offset;
    const Vec3 gradient = cell_gradient(hash_cell(wrap_cell(static_cast<int64_t>(lattice.x), period),
                                                  wrap_cell(static_cast<int64_t>(lattice.y), period),
                                                  wrap_cell(static_cast<int64_t>(lattice.z), period), seed));
    const Vec3 w = offset * fade + (1.0 - offset) * (1.0 - fade);
    sum += w.x * w.y * w.z * glm::dot(gradient, f - offset);
  }
  return 1.6 * sum;  // unit gradients leave the values within about +-0.65
}

double fractal_noise(const Vec3& p, int octaves, uint64_t seed, int period) {
  double sum = 0, weight = 0.5, frequency = 1;
  for (int k = 0; k < octaves; ++k, weight /= 2, frequency *= 2)
    sum += weight * gradient_noise(frequency * p, seed + static_cast<uint64_t>(k),
                                   static_cast<int>(frequency) * period);
  return sum;
}

CellularNoise cellular_noise(Vec2 p, uint64_t seed, int period) {
  const Vec2 cell = glm::floor(p);
  CellularNoise result{1e9, 1e9, 0};
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const Vec2 lattice = cell + Vec2(dx, dy);
      const uint64_t hash = hash_cell(wrap_cell(static_cast<int64_t>(lattice.x), period),
                                      wrap_cell(static_cast<int64_t>(lattice.y), period), 0, seed);
      const Vec2 point = lattice + Vec2(to_unit(hash), to_unit(mix_bits(hash + 1)));
      const double distance = glm::length(point - p);
      if (distance < result.nearest) {
        result = {distance, result.nearest, to_unit(mix_bits(hash + 2))};
      } else {
        result.second = std::min(result.second, distance);
      }
    }
  return result;
}

}  // namespace alabaster
