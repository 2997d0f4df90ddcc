#include "bssrdf/aggregation_kernel.h"

#include <algorithm>

namespace alabaster {

Rgb aggregate_albedo(const AlbedoField& albedo, const KernelPlacement& placement, const SurfacePoint& entry,
                     const SurfacePoint& exit, double distance, std::span<const KernelTap> taps) {
  constexpr std::size_t run = 6;
  std::array<KernelFootprint, run> storage;
  Rgb sum;
  for (std::size_t first = 0; first < taps.size(); first += run) {
    const auto part = taps.subspan(first, std::min(run, taps.size() - first));
    const std::span<KernelFootprint> footprints(storage.data(), part.size());
    placement.place(entry, exit, distance, part, footprints);
    for (std::size_t k = 0; k < part.size(); ++k) sum += part[k].weight * albedo.filtered(footprints[k]);
  }
  return sum;
}

}  // namespace alabaster
