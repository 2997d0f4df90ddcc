#pragma once

#include "core/vec.h"

namespace alabaster {

/// The part of `v` that lies within a surface of that unit normal.
inline Vec3 within_surface(const Vec3& v, const Vec3& normal) {
  return v - glm::dot(v, normal) * normal;
}

}  // namespace alabaster
