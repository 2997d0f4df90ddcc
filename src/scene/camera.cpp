#include "scene/camera.h"

#include <cmath>

namespace alabaster {

Ray Camera::ray(Vec2 pixel, int width, int height) const {
  const Vec3 right = glm::normalize(glm::cross(direction, up));
  const Vec3 image_up = glm::cross(right, direction);
  // Image plane coordinates: y from +1 (top) to -1, x in the same unit.
  const double y = 1 - 2 * pixel.y / height;
  const double x = (2 * pixel.x - width) / height;
  Ray ray;
  if (orthographic_height > 0) {
    const double half = 0.5 * orthographic_height;
    ray.origin = position + half * (x * right + y * image_up);
    ray.direction = direction;
  } else {
    const double half = std::tan(vertical_fov * pi / 360);
    ray.origin = position;
    ray.direction = glm::normalize(direction + half * (x * right + y * image_up));
  }
  return ray;
}

}  // namespace alabaster
