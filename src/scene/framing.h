#pragma once

#include "scene/scene.h"

namespace alabaster {

/// A camera that shows all objects from the front right and a little above, so near that they cover about
/// `coverage` of a square image, but never leave it. Needs a prepared scene.
Camera frame_objects(const Scene& scene, double coverage = 0.45);

}  // namespace alabaster
