#pragma once

#include <string>

#include "scene/scene.h"

namespace alabaster {

/// 32 hexadecimal digits that differ, for all practical purposes, whenever an image of the scene from its
/// first camera could: meshes, textures, media, lights and camera by their bytes, environments and albedo
/// fields by their values at fixed places.
std::string scene_fingerprint(const Scene& scene);

}  // namespace alabaster
