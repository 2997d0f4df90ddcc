#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bssrdf/placements.h"
#include "geometry/geodesic.h"

namespace alabaster {

/// What a basis may take for the distance between entry and exit, beside the chord: chord, normal-corrected,
/// geodesic (the straightest path). docs/geodesics.md has what each does to images.
const std::vector<std::string>& distance_names();

/// Null for the chord. Throws InputError, naming those that there are, for a name that is not among them.
std::unique_ptr<const Geodesic> make_surface_distance(std::string_view name, const PlacementBody& body);

inline constexpr std::string_view default_distance = "chord";

}  // namespace alabaster
