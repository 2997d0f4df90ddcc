#include "bssrdf/composite.h"

#include <algorithm>

#include "bssrdf/aggregation_kernel.h"
#include "bssrdf/last_collision.h"
#include "bssrdf/surroundings.h"

namespace alabaster {
namespace {

/// alpha_i alpha_e / alpha_t; 0 where any of them is 0. On a constant texture the factors cancel up to
/// rounding.
double local_factor(double entry, double exit, double between) {
  return between > 0 ? entry * (exit / between) : 0;
}

Rgb local_factor(const Rgb& entry, const Rgb& exit, const Rgb& between) {
  return {local_factor(entry.r, exit.r, between.r), local_factor(entry.g, exit.g, between.g),
          local_factor(entry.b, exit.b, between.b)};
}

}  // namespace

CompositeBssrdf::CompositeBssrdf(const BssrdfMedium& medium, const KernelPlacement& placement,
                                 Variant variant)
    : Bssrdf(medium), placement_(placement), variant_(variant), taps_(ek17_kernel) {
  if (variant == Variant::symmetric) taps_ = symmetric_ek17_kernel;
}

Rgb CompositeBssrdf::evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
  const Rgb last = variant_ == Variant::view ? last_collision_albedo(medium_, placement_, exit) : exit.albedo;
  if ((entry.albedo * last).is_black()) return {};
  PairShape shape = pair(entry, exit);
  const Rgb between =
      aggregate_albedo(*medium_.albedo, placement_, entry.surface, exit.surface, shape.distance, taps_);
  take_distance(shape, entry, exit);
  return local_factor(entry.albedo, last, between) * basis_over_albedo(between, shape);
}

Rgb CompositeBssrdf::typical_albedo(const BssrdfPoint& exit) const {
  if (variant_ == Variant::view) return albedo_around(medium_, placement_, exit);
  if (exit.albedo.is_black()) return {};
  Rgb around = albedo_around(medium_, placement_, exit);
  for (int c = 0; c < 3; ++c)
    if (exit.albedo[c] == 0) around[c] = 0;
  return around;
}

double CompositeBssrdf::typical_albedo_reach() const {
  return smooth_distance(medium_);
}

OrderOneApartBssrdf::OrderOneApartBssrdf(const BssrdfMedium& medium, const KernelPlacement& placement)
    : Bssrdf(medium), placement_(placement) {}

Rgb OrderOneApartBssrdf::evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
  PairShape shape = pair(entry, exit);
  const Rgb between =
      aggregate_albedo(*medium_.albedo, placement_, entry.surface, exit.surface, shape.distance, ek17_kernel);
  take_distance(shape, entry, exit);
  const Rgb once = basis_over_albedo(Rgb(0), shape);
  const Rgb more = basis_over_albedo(between, shape) - once;
  return between * once + local_factor(entry.albedo, exit.albedo, between) * more;
}

Rgb OrderOneApartBssrdf::typical_albedo(const BssrdfPoint& exit) const {
  return albedo_around(medium_, placement_, exit);
}

double OrderOneApartBssrdf::typical_albedo_reach() const {
  return smooth_distance(medium_);
}

}  // namespace alabaster
