#pragma once

#include <string>

#include "core/vec.h"
#include "geometry/ray_scene.h"

namespace alabaster {

/// Perspective (or orthographic) camera. Pixel (0, 0) is top left.
struct Camera {
  std::string name;   // of the node that holds it, or its own
  std::string alias;  // another name it goes by
  Vec3 position{0, 0, 1};
  Vec3 direction{0, 0, -1};        // unit
  Vec3 up{0, 1, 0};                // any vector not parallel to direction
  double vertical_fov = 40;        // degrees; perspective
  double orthographic_height = 0;  // m; > 0 makes it orthographic

  /// Ray through image position (x, y) in pixels of an image of that size; unit direction.
  Ray ray(Vec2 pixel, int width, int height) const;
};

}  // namespace alabaster
