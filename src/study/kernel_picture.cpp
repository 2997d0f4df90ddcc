#include "study/kernel_picture.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace alabaster {

namespace {

constexpr double distances_across = 4;

uint8_t display(double linear) {
  return static_cast<uint8_t>(std::lround(255 * std::pow(glm::clamp(linear, 0.0, 1.0), 1 / 2.2)));
}

Vec3 texel(const PlanarScene& scene, Vec2 point) {
  const Vec2 uv = scene.uv(point), inside = uv - glm::floor(uv);
  const TexelArray& texels = *scene.albedo;
  const int x = std::min(static_cast<int>(inside.x * texels.width), texels.width - 1),
            y = std::min(static_cast<int>(inside.y * texels.height), texels.height - 1);
  return Vec3(Vec4(texels.at(x, y)));
}

/// The greatest density: the Gaussians of a kernel may overlap, so it is looked for.
double peak_density(std::span<const KernelTap> taps) {
  double peak = 0;
  for (const KernelTap& tap : taps) peak = std::max(peak, kernel_density(taps, tap.along, tap.across));
  return peak;
}

}  // namespace

double kernel_density(std::span<const KernelTap> taps, double along, double across) {
  double sum = 0;
  for (const KernelTap& tap : taps) {
    assert(tap.sigma > 0);
    const double a = along - tap.along, b = across - tap.across, variance = tap.sigma * tap.sigma;
    sum += tap.weight * std::exp(-0.5 * (a * a + b * b) / variance) / (2 * pi * variance);
  }
  return sum;
}

Pixels8 kernel_over_texture(const PlanarScene& scene, Vec2 entry, Vec2 exit, std::span<const KernelTap> taps,
                            int size) {
  const Vec2 along = exit - entry, across(-along.y, along.x), middle = 0.5 * (entry + exit);
  const double distance = glm::length(along), pixel = distances_across / size;  // in distances
  assert(distance > 0);
  const double peak = peak_density(taps);
  const Vec3 orange(1, 0.32, 0.02), line(0.75, 0.1, 0);
  Pixels8 picture(size, size, 3);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Vec2 point = middle + distance * pixel * Vec2(x + 0.5 - 0.5 * size, 0.5 * size - y - 0.5);
      const Vec2 frame =
          Vec2(glm::dot(point - entry, along), glm::dot(point - entry, across)) / (distance * distance);
      Vec3 colour = texel(scene, point);
      colour = glm::mix(colour, orange, 0.85 * std::sqrt(kernel_density(taps, frame.x, frame.y) / peak));
      for (const KernelTap& tap : taps)
        if (std::abs(glm::distance(frame, Vec2(tap.along, tap.across)) - tap.sigma) < 0.5 * pixel)
          colour = line;
      const auto disk = [&](Vec2 centre, double shade) {
        const double r = glm::distance(frame, centre) / pixel;
        if (r < 5) colour = Vec3(r < 3.5 ? shade : 1 - shade);
      };
      disk(Vec2(0, 0), 1);
      disk(Vec2(1, 0), 0);
      for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = display(colour[c]);
    }
  return picture;
}

}  // namespace alabaster
