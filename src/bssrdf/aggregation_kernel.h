#pragma once

#include <array>
#include <span>

#include "bssrdf/kernel_placement.h"

namespace alabaster {

/// [EK17] eq. 1: three isotropic Gaussians with weights w = t = {4, 2, 1}/7, means x_i + t_k (x_e - x_i),
/// standard deviations t_k d.
inline constexpr std::array<KernelTap, 3> ek17_kernel{{
    {4.0 / 7, 0, 4.0 / 7, 4.0 / 7},
    {2.0 / 7, 0, 2.0 / 7, 2.0 / 7},
    {1.0 / 7, 0, 1.0 / 7, 1.0 / 7},
}};

/// Eq. 1's means start at the entry, so it is not reciprocal. This is its mean with the kernel of the swapped
/// pair.
inline constexpr std::array<KernelTap, 6> symmetric_ek17_kernel{{
    {4.0 / 7, 0, 4.0 / 7, 2.0 / 7},
    {3.0 / 7, 0, 4.0 / 7, 2.0 / 7},
    {2.0 / 7, 0, 2.0 / 7, 1.0 / 7},
    {5.0 / 7, 0, 2.0 / 7, 1.0 / 7},
    {1.0 / 7, 0, 1.0 / 7, 0.5 / 7},
    {6.0 / 7, 0, 1.0 / 7, 0.5 / 7},
}};

/// The albedo averaged by a kernel placed between two points: one lookup per tap. `distance` > 0, m.
Rgb aggregate_albedo(const AlbedoField& albedo, const KernelPlacement& placement, const SurfacePoint& entry,
                     const SurfacePoint& exit, double distance, std::span<const KernelTap> taps);

}  // namespace alabaster
