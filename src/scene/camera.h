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

/// A camera's rays through an image of fixed size: what all of them share is computed once.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height);
  /// As Camera::ray.
  Ray ray(Vec2 pixel) const;

 private:
  Vec3 position_, direction_;
  Vec3 right_, down_;  // per pixel, on the image plane one unit away
  Vec2 middle_;        // pixels
  bool orthographic_;
};

}  // namespace alabaster
