#pragma once

#include "bssrdf/bssrdf.h"

namespace alabaster {

/// The albedo that light seen at an exit was last scattered with. Eq. 2 of [EK17] reads alpha_e at the exit
/// itself, which is right for who looks straight down: then the last collision lies right below. Light that
/// leaves at a slant came along the refracted view ray, from a collision whose distance along it is
/// distributed about as exp(-sigma_t s) and thus lies sideways by up to 2/3 mean free path on average. Here
/// the texture is averaged along that ray, by two Gaussians in the exit's tangent plane; without a direction,
/// around the exit, over all directions. On the shape basis the ray ends half-way through the body, where the
/// other side's texture begins. Exactly the exit's albedo on one albedo or straight down. [0, 1], per
/// channel.
Rgb last_collision_albedo(const BssrdfMedium& medium, const KernelPlacement& placement,
                          const BssrdfPoint& exit);

}  // namespace alabaster
