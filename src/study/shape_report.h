#pragma once

#include <filesystem>

#include "optics/profile_table.h"
#include "optics/shape_table.h"

namespace alabaster {

/// Draws a table of shapes into `folder`: shape_balls.svg and shape_cavities.svg (factors over the chord),
/// shape_slab_near.svg and shape_slab_far.svg (over the lateral distance), all at albedo 0.9, and
/// shape_returned.svg (what bodies return over what the half-space does, over their size).
void write_shape_report(const ShapeTable& table, const ProfileTable& half_space,
                        const std::filesystem::path& folder);

}  // namespace alabaster
