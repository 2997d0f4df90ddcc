#include "bssrdf/bssrdf.h"

#include <algorithm>
#include <cassert>

#include "bssrdf/aggregate.h"
#include "bssrdf/composite.h"
#include "bssrdf/factorized.h"
#include "bssrdf/homogeneous.h"
#include "core/error.h"

namespace alabaster {

Bssrdf::Bssrdf(const BssrdfMedium& medium) : medium_(medium), distances_(*medium.profile) {
  assert(medium.profile != nullptr && medium.albedo != nullptr && medium.sigma_t.min() > 0);
  if (medium.shape != nullptr) shaped_.emplace(*medium.profile, *medium.shape->families, medium.sigma_t);
}

Rgb Bssrdf::aim(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
  if (!shaped_) return {};
  return medium_.shape->families->aim(pair(entry, exit), 0.5 * (entry.albedo + exit.albedo),
                                      shaped_->paths());
}

Rgb Bssrdf::half_space_over_albedo(const Rgb& albedo, double distance) const {
  const Rgb& sigma_t = medium_.sigma_t;
  if (sigma_t.is_grey())
    return sigma_t.r * sigma_t.r * medium_.profile->evaluate_over_albedo(albedo, sigma_t.r * distance);
  return sigma_t * sigma_t * medium_.profile->evaluate_over_albedo(albedo, distance * sigma_t);
}

// Half of the draws follow the exit's albedo, half the largest anywhere: a dark exit amid bright surroundings
// would otherwise starve of the distances that matter there.
double Bssrdf::sample_distance(const BssrdfPoint& exit, int channel, double u) const {
  const bool local = u < 0.5;
  const double albedo = local ? exit.albedo[channel] : medium_.albedo->max()[channel];
  const double rest = local ? 2 * u : 2 * u - 1;
  return distances_.sample(DistanceTable::level(albedo), rest) / medium_.sigma_t[channel];
}

double Bssrdf::pdf_distance(const BssrdfPoint& exit, int channel, double distance) const {
  const double sigma_t = medium_.sigma_t[channel], rho = sigma_t * distance;
  const int local = DistanceTable::level(exit.albedo[channel]);
  const int brightest = DistanceTable::level(medium_.albedo->max()[channel]);
  return 0.5 * sigma_t * (distances_.pdf(local, rho) + distances_.pdf(brightest, rho));
}

std::unique_ptr<Bssrdf> make_bssrdf(std::string_view name, const BssrdfMedium& medium,
                                    const BssrdfOptions& options) {
  if (name == "homogeneous") return std::make_unique<HomogeneousBssrdf>(medium);
  if (name == "factorized") return std::make_unique<FactorizedBssrdf>(medium);
  const auto placement = [&]() -> const KernelPlacement& {
    assert(options.placement != nullptr);
    return *options.placement;
  };
  if (name == "aggregate")
    return std::make_unique<AggregateBssrdf>(medium, placement(), options.ellipse_width,
                                             options.ellipse_samples);
  if (name == "composite") return std::make_unique<CompositeBssrdf>(medium, placement());
  if (name == "composite:symmetric")
    return std::make_unique<CompositeBssrdf>(medium, placement(), CompositeBssrdf::Variant::symmetric);
  if (name == "composite:view")
    return std::make_unique<CompositeBssrdf>(medium, placement(), CompositeBssrdf::Variant::view);
  if (name == "composite:order1") return std::make_unique<OrderOneApartBssrdf>(medium, placement());
  throw InputError("there is no model \"" + std::string(name) +
                   "\"; use homogeneous, factorized, aggregate, composite, composite:symmetric, "
                   "composite:order1 or composite:view");
}

}  // namespace alabaster
