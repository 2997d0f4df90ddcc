#include "bssrdf/aggregation_kernel.h"

#include <cassert>

namespace alabaster {

Rgb aggregate_albedo(const AlbedoField& albedo, const KernelPlacement& placement, const SurfacePoint& entry,
                     const SurfacePoint& exit, double distance, std::span<const KernelTap> taps) {
  assert(taps.size() <= max_kernel_taps);
  std::array<KernelFootprint, max_kernel_taps> storage;
  const std::span<KernelFootprint> footprints(storage.data(), taps.size());
  placement.place(entry, exit, distance, taps, footprints);
  Rgb sum;
  for (std::size_t k = 0; k < taps.size(); ++k) sum += taps[k].weight * albedo.filtered(footprints[k]);
  return sum;
}

}  // namespace alabaster
