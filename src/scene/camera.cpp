#include "scene/camera.h"

#include <cmath>

namespace alabaster {

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : position_(camera.position),
      direction_(camera.direction),
      middle_(0.5 * width, 0.5 * height),
      orthographic_(camera.orthographic_height > 0) {
  const Vec3 right = glm::normalize(glm::cross(camera.direction, camera.up));
  const Vec3 up = glm::cross(right, camera.direction);
  const double half =
      orthographic_ ? 0.5 * camera.orthographic_height : std::tan(camera.vertical_fov * pi / 360);
  right_ = (2 * half / height) * right;
  down_ = (-2 * half / height) * up;
}

Ray CameraRays::ray(Vec2 pixel) const {
  const Vec3 offset = (pixel.x - middle_.x) * right_ + (pixel.y - middle_.y) * down_;
  Ray ray;
  ray.origin = orthographic_ ? position_ + offset : position_;
  ray.direction = orthographic_ ? direction_ : glm::normalize(direction_ + offset);
  return ray;
}

Ray Camera::ray(Vec2 pixel, int width, int height) const {
  return CameraRays(*this, width, height).ray(pixel);
}

}  // namespace alabaster
