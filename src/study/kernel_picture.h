#pragma once

#include <span>

#include "bssrdf/kernel_placement.h"
#include "image/png_file.h"
#include "integrators/planar_scene.h"

namespace alabaster {

/// Density of a kernel's Gaussians in the frame of the pair, lengths in its distance: (0, 0) the entry, (1,
/// 0) the exit. Integrates to the sum of the weights. Every tap's sigma > 0.
double kernel_density(std::span<const KernelTap> taps, double along, double across);

/// [EK17] figures 2 and 3: where a kernel looks for the albedo between two points of a flat scene. The
/// texture around the pair, four distances wide, `size` pixels square; the kernel's density laid over it in
/// orange (opacity: square root of density over its peak), a line where each Gaussian is one deviation from
/// its mean; the entry is a white disk, the exit a black one.
Pixels8 kernel_over_texture(const PlanarScene& scene, Vec2 entry, Vec2 exit, std::span<const KernelTap> taps,
                            int size);

}  // namespace alabaster
