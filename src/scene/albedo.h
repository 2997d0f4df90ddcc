#pragma once

#include "scene/scene.h"

namespace alabaster {

/// Sets albedo of every object that has a medium and mean_albedo of every such material: colours become
/// single-scattering albedos texel by texel. Adds one warning per material whose reflectance had to be
/// clamped.
void build_albedo_fields(Scene& scene, Purpose purpose);

}  // namespace alabaster
