#include "bssrdf/aggregation_kernel.h"

#include <algorithm>

namespace alabaster {

namespace {

template <std::size_t run>
Rgb aggregate(const AlbedoField& albedo, const KernelPlacement& placement, const SurfacePoint& entry,
              const SurfacePoint& exit, double distance, std::span<const KernelTap> taps) {
  std::array<KernelFootprint, run> storage;
  Rgb sum;
  for (std::size_t first = 0; first < taps.size(); first += run) {
    const auto part = taps.subspan(first, std::min(run, taps.size() - first));
    const std::span<KernelFootprint> footprints(storage.data(), part.size());
    placement.place(entry, exit, distance, part, footprints);
    std::array<double, run> weights;
    for (std::size_t k = 0; k < part.size(); ++k) weights[k] = part[k].weight;
    sum += albedo.mixture(footprints, std::span<const double>(weights.data(), part.size()));
  }
  return sum;
}

}  // namespace

Rgb aggregate_albedo(const AlbedoField& albedo, const KernelPlacement& placement, const SurfacePoint& entry,
                     const SurfacePoint& exit, double distance, std::span<const KernelTap> taps) {
  // Room for no more than there are: clearing it takes its time.
  return taps.size() <= 3 ? aggregate<3>(albedo, placement, entry, exit, distance, taps)
                          : aggregate<6>(albedo, placement, entry, exit, distance, taps);
}

}  // namespace alabaster
