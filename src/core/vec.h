#pragma once
// Vectors are GLM's; double in all computation, float where arrays are stored.

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace alabaster {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Vec4 = glm::dvec4;
using Vec2f = glm::vec2;
using Vec3f = glm::vec3;
using Vec4f = glm::vec4;
using Mat2 = glm::dmat2;
using Mat3 = glm::dmat3;
using Mat4 = glm::dmat4;

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double inv_pi = 0.31830988618379067154;

inline double length_squared(const Vec3& v) {
  return glm::dot(v, v);
}

}  // namespace alabaster
