#include "scene/framing.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

namespace {

constexpr int grid = 64;  // rays per side that measure coverage

double covered_fraction(const Scene& scene, const Camera& camera) {
  int hits = 0;
  for (int y = 0; y < grid; ++y)
    for (int x = 0; x < grid; ++x)
      hits += scene.rays.nearest(camera.ray({x + 0.5, y + 0.5}, grid, grid)).has_value() ? 1 : 0;
  return hits / static_cast<double>(grid * grid);
}

/// The smallest distance from the centre at which every vertex lies within `margin` of the square image.
double least_distance(const Scene& scene, const Camera& camera, const Vec3& centre, double margin) {
  const double slope = margin * std::tan(camera.vertical_fov * pi / 360);
  const Vec3 right = glm::normalize(glm::cross(camera.direction, camera.up));
  const Vec3 up = glm::cross(right, camera.direction);
  double distance = 0;
  for (const SceneObject& object : scene.objects) {
    for (const Vec3& p : object.mesh.positions) {
      const Vec3 v = p - centre;
      const double side = std::max(std::abs(glm::dot(v, right)), std::abs(glm::dot(v, up)));
      distance = std::max(distance, side / slope - glm::dot(v, camera.direction));
    }
  }
  return distance;
}

}  // namespace

Camera frame_objects(const Scene& scene, double coverage) {
  Camera camera;
  camera.name = "framed";
  camera.direction = glm::normalize(Vec3(-0.5, -0.35, -0.85));
  const Vec3 centre = scene.bounds.centre();
  const double size = std::max(scene.bounds.diagonal(), 1e-9);
  double near = least_distance(scene, camera, centre, 0.96);
  double far = std::max(4 * near, 8 * size);
  near = std::max(near, 1e-3 * size);
  // Coverage falls with distance: halve the interval.
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (near + far);
    camera.position = centre - middle * camera.direction;
    (covered_fraction(scene, camera) > coverage ? near : far) = middle;
  }
  camera.position = centre - near * camera.direction;
  return camera;
}

}  // namespace alabaster
