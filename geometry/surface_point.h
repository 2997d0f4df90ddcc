#pragma once

#include <cstdint>

#include "core/vec.h"

namespace alabaster {

/// A point on an object's surface.
struct SurfacePoint {
  Vec3 position{0};          // m, world space
  Vec3 geometric_normal{0};  // unit, outwards
  Vec3 shading_normal{0};    // unit, on the same side
  Vec2 uv{0};                // set 0 of the mesh
  Vec2 barycentric{0};       // weights of the second and third corner
  uint32_t triangle = 0;
  uint32_t object = 0;
};

}  // namespace alabaster
