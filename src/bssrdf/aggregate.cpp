#include "bssrdf/aggregate.h"

#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "bssrdf/aggregation_kernel.h"
#include "bssrdf/surroundings.h"
#include "core/error.h"
#include "core/rng.h"

namespace alabaster {
namespace {

constexpr int max_samples = 64;

/// The uniform ellipse is nearly a Gaussian across (standard deviation half the semi-axis) times a semicircle
/// law along the line between the foci, for which Gauss-Chebyshev quadrature of the second kind is exact.
std::vector<KernelTap> ellipse_taps(double minor) {
  constexpr int count = 5;
  std::vector<KernelTap> taps;
  for (int k = 1; k <= count; ++k) {
    const double angle = pi * k / (count + 1);
    const double s = std::sin(angle);
    taps.push_back({0.5 + 0.5 * std::cos(angle), 0, 0.5 * minor, 2 * s * s / (count + 1)});
  }
  return taps;
}

double fraction(double v) {
  return v - std::floor(v);
}

uint64_t pair_hash(const SurfacePoint& a, const SurfacePoint& b) {
  uint64_t hash = 0;
  for (const double v : {a.position.x, a.position.y, a.position.z, b.position.x, b.position.y, b.position.z})
    hash = hash_combine(hash, std::bit_cast<uint64_t>(v));
  return hash;
}

}  // namespace

AggregateBssrdf::AggregateBssrdf(const BssrdfMedium& medium, const KernelPlacement& placement, double width,
                                 int samples)
    : Bssrdf(medium),
      placement_(placement),
      minor_(0.5 * width),
      major_(0.5 * std::sqrt(1 + width * width)),
      samples_(samples),
      taps_(ellipse_taps(minor_)) {
  if (!(width >= 0)) throw InputError("aggregate: the ellipse's width must be 0 or more");
  if (samples < 0 || samples > max_samples) throw InputError("aggregate: the ellipse takes 0 to 64 samples");
}

Rgb AggregateBssrdf::ellipse_mean(const BssrdfPoint& entry, const BssrdfPoint& exit, double distance) const {
  if (samples_ == 0)
    return aggregate_albedo(*medium_.albedo, placement_, entry.surface, exit.surface, distance, taps_);
  Rng shift(pair_hash(entry.surface, exit.surface));
  const double shift_x = shift.uniform(), shift_y = shift.uniform();
  std::array<KernelTap, max_samples> taps;
  for (int k = 0; k < samples_; ++k) {
    // Additive recurrence with the plastic number (Roberts 2018), shifted by Cranley-Patterson rotation.
    const double radius = std::sqrt(fraction(shift_x + 0.7548776662466927 * k));
    const double angle = 2 * pi * fraction(shift_y + 0.5698402909980532 * k);
    taps[static_cast<std::size_t>(k)] = {0.5 + major_ * radius * std::cos(angle),
                                         minor_ * radius * std::sin(angle), 0, 1.0 / samples_};
  }
  return aggregate_albedo(*medium_.albedo, placement_, entry.surface, exit.surface, distance,
                          std::span(taps.data(), static_cast<std::size_t>(samples_)));
}

Rgb AggregateBssrdf::evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
  PairShape shape = pair(entry, exit);
  const Rgb mean = ellipse_mean(entry, exit, shape.distance);
  take_distance(shape, entry, exit);
  return mean * basis_over_albedo(mean, shape);
}

Rgb AggregateBssrdf::typical_albedo(const BssrdfPoint& exit) const {
  return albedo_around(medium_, placement_, exit);
}

double AggregateBssrdf::typical_albedo_reach() const {
  return smooth_distance(medium_);
}

}  // namespace alabaster
