#include "scene/albedo.h"

namespace alabaster {

// Fields over the surface come with texture/material_map.
void build_albedo_fields(Scene&) {}

}  // namespace alabaster
