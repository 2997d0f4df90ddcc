#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

// What walks through a volume cannot do is refused before they begin: InputError, one line each.

/// The object is closed; else one edge of its border is named.
void check_closed(const Scene& scene, const SceneObject& object);
/// All of the object's triangles bound the medium, `boundary` having a flag per material.
void check_one_medium(const Scene& scene, const SceneObject& object, const std::vector<uint8_t>& boundary);
/// No two objects with a medium touch, cross or lie within one another.
void check_media_apart(const Scene& scene);

}  // namespace alabaster
