#include "bssrdf/body_light.h"

#include <algorithm>
#include <cmath>

namespace alabaster {
namespace {

constexpr double first_octave = -2;

double ratio_of(double part, double rest) {
  return part > 0 ? part / (part + rest) : 0;
}

// Over the surface in steps of log distance; a few per cent are good enough.
template <typename Density>
double over_surface(double first, double last, const Density& density) {
  constexpr int steps = 64;
  const double step = std::log(last / first) / steps;
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double d = first * std::exp((k + 0.5) * step);
    sum += 2 * pi * d * d * step * density(d);
  }
  return sum;
}

}  // namespace

BodyLight::BodyLight(const ProfileTable& profile, const ShapeFamilies& families) {
  for (const bool slab : {false, true})
    for (int level = 0; level < DistanceTable::level_count; ++level)
      for (int size = 0; size < sizes; ++size) {
        const double thickness = std::exp2(first_octave + 0.5 * size), albedo = DistanceTable::albedo(level);
        const auto plain = [&](double chord) { return profile.evaluate_over_albedo(albedo, chord); };
        double across = 0, around = 0;
        if (slab) {
          around = over_surface(1e-3, 100 * thickness, [&](double d) {
            return plain(d) * families.factor(ShapeFamily::slab_near, thickness, d, albedo);
          });
          across = over_surface(1e-3 * thickness, 100 * thickness, [&](double d) {
            return plain(std::hypot(d, thickness)) *
                   families.factor(ShapeFamily::slab_far, thickness, d, albedo);
          });
        } else {
          around = over_surface(1e-3, thickness, plain);
          across = over_surface(0.3 * thickness, thickness, [&](double d) {
            return plain(d) *
                   std::max(0.0, families.factor(ShapeFamily::ball, 0.5 * thickness, d, albedo) - 1);
          });
        }
        shares_.push_back(static_cast<float>(ratio_of(across, around)));
      }
}

double BodyLight::share(int level, double thickness, double sphericity) const {
  const double position = std::max(0.0, 2 * (std::log2(thickness) - first_octave));
  if (!(position < sizes - 1)) return 0;
  const int size = static_cast<int>(position);
  const auto at = [&](int slab) {
    const float* row =
        &shares_[static_cast<std::size_t>((slab * DistanceTable::level_count + level) * sizes + size)];
    return double{row[0]} + (position - size) * (double{row[1]} - double{row[0]});
  };
  // A cylinder, half a ball, is nearer to the ball.
  return at(1) + std::sqrt(sphericity) * (at(0) - at(1));
}

}  // namespace alabaster
