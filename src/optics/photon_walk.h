#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/frame.h"
#include "core/rng.h"
#include "core/vec.h"
#include "optics/fresnel.h"
#include "optics/phase_function.h"

// The pieces of a photon's random walk in optical units (mean free paths), scalar and double: the oracle of
// the vectorised walk, and what walks in other shapes are built of.

namespace alabaster {

/// What the photon is in: mean cosine g in (-1, 1), relative index eta >= 1 against the outside.
struct WalkMedium {
  double g = 0.3;
  double eta = 1.5;
};

struct Photon {
  Vec3 position{0};
  Vec3 direction{0, 0, 1};
  int64_t order = 0;  // collisions so far
};

/// Length of a free flight, exponential of mean 1.
inline double sample_free_flight(Rng& rng) {
  return -std::log(rng.uniform_positive());
}

/// Unit vector of uniform azimuth: von Neumann's rejection, which is cheaper than a sine and a cosine.
inline Vec2 sample_azimuth(Rng& rng) {
  for (;;) {
    const double a = 2 * rng.uniform() - 1, b = 2 * rng.uniform() - 1;
    const double r2 = a * a + b * b;
    if (r2 > 1 || r2 < 1e-30) continue;
    return {(a * a - b * b) / r2, 2 * a * b / r2};
  }
}

/// `axis` turned by the angle of that cosine about a uniform azimuth.
inline Vec3 deflect(const Vec3& axis, double cosine, Rng& rng) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const Vec2 azimuth = sample_azimuth(rng);
  const Vec3 turned = Frame(axis).to_world({sine * azimuth.x, sine * azimuth.y, cosine});
  // One Newton step keeps the length at 1 over millions of turns.
  return turned * (1.5 - 0.5 * glm::dot(turned, turned));
}

/// A Henyey-Greenstein scattering event.
inline Vec3 scatter(const Vec3& direction, double g, Rng& rng) {
  return deflect(direction, sample_henyey_greenstein(rng.uniform(), g), rng);
}

/// Whether light that meets the boundary from inside is reflected back; `cosine` > 0 is to the outward
/// normal.
inline bool reflected_inside(double cosine, double eta, Rng& rng) {
  const double reflectance = fresnel_dielectric(cosine, 1 / eta);
  return reflectance > 0 && rng.uniform() < reflectance;
}

/// Direction just inside a surface of inward normal +z, of uniform radiance that crossed it.
inline Vec3 sample_diffuse_entry(double eta, Rng& rng) {
  for (;;) {
    const double cosine = std::sqrt(rng.uniform_positive());
    if (eta > 1 && rng.uniform() < fresnel_dielectric(cosine, eta)) continue;
    return deflect({0, 0, 1}, refracted_cosine(cosine, eta), rng);
  }
}

/// The medium below z = 0, depth along +z.
struct HalfSpace {
  double boundary_distance(const Vec3& position, const Vec3& direction) const {
    return direction.z < 0 ? position.z / -direction.z : std::numeric_limits<double>::infinity();
  }
  void snap(Photon& photon) const { photon.position.z = 0; }
  Vec3 outward_normal(const Vec3&) const { return {0, 0, -1}; }
};

/// The medium between z = 0, where light enters, and z = thickness.
struct Slab {
  double thickness;

  double boundary_distance(const Vec3& position, const Vec3& direction) const {
    if (direction.z == 0) return std::numeric_limits<double>::infinity();
    return direction.z < 0 ? position.z / -direction.z : (thickness - position.z) / direction.z;
  }
  void snap(Photon& photon) const { photon.position.z = photon.direction.z < 0 ? 0 : thickness; }
  Vec3 outward_normal(const Vec3& position) const {
    return {0, 0, position.z > 0.5 * thickness ? 1.0 : -1.0};
  }
};

enum class WalkEnd { left, stopped };

/// Walks until the photon leaves the shape or `collide(photon, rng)` returns false, which it is asked at
/// every collision, the collision already counted in photon.order and the scattering not yet drawn. On `left`
/// the photon stands on the boundary and its direction is still that inside.
///
/// A shape has boundary_distance(position, direction) along a ray inside (>= 0 up to rounding), snap(photon),
/// which puts a photon exactly on the boundary it reached, and outward_normal(position) there.
template <typename Shape, typename Collide>
WalkEnd walk(const Shape& shape, const WalkMedium& medium, Photon& photon, Rng& rng, Collide&& collide) {
  for (;;) {
    const double flight = sample_free_flight(rng);
    const double boundary = shape.boundary_distance(photon.position, photon.direction);
    if (flight < boundary) {
      photon.position += flight * photon.direction;
      ++photon.order;
      if (!collide(photon, rng)) return WalkEnd::stopped;
      photon.direction = scatter(photon.direction, medium.g, rng);
      continue;
    }
    photon.position += boundary * photon.direction;
    shape.snap(photon);
    const Vec3 normal = shape.outward_normal(photon.position);
    const double cosine = std::abs(glm::dot(photon.direction, normal));
    if (!reflected_inside(cosine, medium.eta, rng)) return WalkEnd::left;
    photon.direction -= 2 * glm::dot(photon.direction, normal) * normal;
  }
}

}  // namespace alabaster
