#pragma once

#include <string>

#include "integrators/planar_scene.h"
#include "scene/scene.h"

namespace alabaster {

/// 32 hexadecimal digits that differ, for all practical purposes, whenever an image of the scene from its
/// first camera could: meshes, textures, media, lights and camera by their bytes, environments and albedo
/// fields by their values at fixed places.
std::string scene_fingerprint(const Scene& scene);
/// The same for a flat scene, view included.
std::string scene_fingerprint(const PlanarScene& scene);

}  // namespace alabaster
