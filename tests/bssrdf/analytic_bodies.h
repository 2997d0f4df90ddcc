#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "bssrdf/pair_shape.h"
#include "core/frame.h"
#include "optics/photon_walk.h"

namespace alabaster {

/// A body by equations, for photon walks in its exact shape and for quadrature over its surface. Optical
/// units.
struct AnalyticBody {
  std::string name;
  /// Of the level surface through a point.
  std::function<Vec3(const Vec3&)> normal;
  std::vector<std::function<Vec3(Vec2)>> patches;  // from [0, 1]^2
  /// Along a ray inside, and the exact point on the surface nearest to one almost there.
  std::function<double(const Vec3&, const Vec3&)> boundary;
  std::function<Vec3(const Vec3&)> onto;

  double boundary_distance(const Vec3& p, const Vec3& w) const { return boundary(p, w); }
  void snap(Photon& photon) const { photon.position = onto(photon.position); }
  Vec3 outward_normal(const Vec3& p) const { return normal(p); }

  LocalShape shape(const Vec3& p) const {
    LocalShape local;
    local.normal = normal(p);
    const Frame frame(local.normal);
    const double step = 1e-5;
    const auto slope = [&](const Vec3& t) {
      return (normal(p + step * t) - normal(p - step * t)) / (2 * step);
    };
    const Vec3 a = slope(frame.tangent), b = slope(frame.bitangent);
    const double s11 = glm::dot(a, frame.tangent), s22 = glm::dot(b, frame.bitangent);
    const double s12 = 0.5 * (glm::dot(a, frame.bitangent) + glm::dot(b, frame.tangent));
    const double mean = 0.5 * (s11 + s22), spread = std::hypot(0.5 * (s11 - s22), s12);
    local.curvature_min = mean - spread;
    local.curvature_max = mean + spread;
    const double thickness = boundary(p - 1e-7 * local.normal, -local.normal);
    local.inverse_thickness = std::isfinite(thickness) ? 1 / thickness : 0;
    return local;
  }
};

inline AnalyticBody make_ellipsoid_body(std::string name, const Vec3& axes) {
  AnalyticBody body;
  body.name = std::move(name);
  body.normal = [axes](const Vec3& p) { return glm::normalize(p / (axes * axes)); };
  body.patches = {[axes](Vec2 s) {
    const double polar = pi * s.y, azimuth = 2 * pi * s.x;
    return axes *
           Vec3(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
  }};
  body.boundary = [axes](const Vec3& p, const Vec3& w) {
    const Vec3 q = p / axes, d = w / axes;
    const double a = glm::dot(d, d), b = glm::dot(q, d), c = std::max(1 - glm::dot(q, q), 0.0);
    const double root = std::sqrt(b * b + a * c);
    return b > 0 ? c / (root + b) : (root - b) / a;
  };
  body.onto = [axes](const Vec3& p) { return axes * glm::normalize(p / axes); };
  return body;
}

/// Without ends, along y; surface within |y| <= reach only.
inline AnalyticBody make_cylinder_body(std::string name, double radius, double reach) {
  AnalyticBody body;
  body.name = std::move(name);
  body.normal = [](const Vec3& p) { return glm::normalize(Vec3(p.x, 0, p.z)); };
  for (const double side : {-1.0, 1.0})
    body.patches.push_back([radius, reach, side](Vec2 s) {
      const double azimuth = 2 * pi * s.x;
      return Vec3(radius * std::cos(azimuth), side * reach * s.y, radius * std::sin(azimuth));
    });
  body.boundary = [radius](const Vec3& p, const Vec3& w) {
    const double a = w.x * w.x + w.z * w.z, b = p.x * w.x + p.z * w.z;
    const double c = std::max(radius * radius - p.x * p.x - p.z * p.z, 0.0);
    const double root = std::sqrt(b * b + a * c);
    return b > 0 ? c / (root + b) : (root - b) / a;
  };
  body.onto = [radius](const Vec3& p) {
    const double r = std::hypot(p.x, p.z);
    return Vec3(p.x * radius / r, p.y, p.z * radius / r);
  };
  return body;
}

/// Medium for -thickness < z < 0; surface within |x|, |y| <= reach only. Infinitely thick: a half-space.
inline AnalyticBody make_slab_body(std::string name, double thickness, double reach) {
  AnalyticBody body;
  body.name = std::move(name);
  body.normal = [thickness](const Vec3& p) { return Vec3(0, 0, p.z > -0.5 * thickness ? 1 : -1); };
  body.patches = {[reach](Vec2 s) { return Vec3(reach * (2 * s.x - 1), reach * (2 * s.y - 1), 0); }};
  if (std::isfinite(thickness))
    body.patches.push_back([reach, thickness](Vec2 s) {
      return Vec3(reach * (2 * s.x - 1), reach * (2 * s.y - 1), -thickness);
    });
  body.boundary = [thickness](const Vec3& p, const Vec3& w) {
    if (w.z == 0) return HUGE_VAL;
    return std::max(0.0, w.z > 0 ? -p.z / w.z : (p.z + thickness) / -w.z);
  };
  body.onto = [thickness](const Vec3& p) { return Vec3(p.x, p.y, p.z > -0.5 * thickness ? 0 : -thickness); };
  return body;
}

/// Axis y.
inline AnalyticBody make_torus_body(std::string name, double ring, double tube) {
  AnalyticBody body;
  body.name = std::move(name);
  const auto across = [ring](const Vec3& p) {
    const double r = std::hypot(p.x, p.z);
    return Vec3(p.x * (1 - ring / r), p.y, p.z * (1 - ring / r));  // from the tube's circle
  };
  body.normal = [across](const Vec3& p) { return glm::normalize(across(p)); };
  body.patches = {[ring, tube](Vec2 s) {
    const double u = 2 * pi * s.x, v = 2 * pi * s.y, r = ring + tube * std::cos(v);
    return Vec3(r * std::cos(u), tube * std::sin(v), r * std::sin(u));
  }};
  body.onto = [across, tube](const Vec3& p) {
    const Vec3 a = across(p);
    return p + a * (tube / glm::length(a) - 1);
  };
  body.boundary = [across, tube](const Vec3& p, const Vec3& w) {
    double t = 0;
    for (int step = 0; step < 500; ++step) {
      const Vec3 a = across(p + t * w);
      const double inside = tube - glm::length(a), slope = glm::dot(a, w);
      if (inside < 1e-8 * tube && slope > 0) break;
      // The ball around the nearest point of the tube's circle lies within the torus: as far as its surface.
      const double c = std::max(tube * tube - glm::dot(a, a), 0.0), root = std::sqrt(slope * slope + c);
      t += std::max(slope > 0 ? c / (root + slope) : root - slope, 1e-9 * tube);
    }
    return t;
  };
  return body;
}

/// The medium outside a ball.
inline AnalyticBody make_cavity_body(std::string name, double radius) {
  AnalyticBody body;
  body.name = std::move(name);
  body.normal = [](const Vec3& p) { return -glm::normalize(p); };
  body.patches = {[radius](Vec2 s) {
    const double z = 1 - 2 * s.y, azimuth = 2 * pi * s.x, r = std::sqrt(std::max(0.0, 1 - z * z));
    return radius * Vec3(r * std::cos(azimuth), r * std::sin(azimuth), z);
  }};
  body.onto = [radius](const Vec3& p) { return radius * glm::normalize(p); };
  body.boundary = [radius](const Vec3& p, const Vec3& w) {
    const double b = -glm::dot(p, w), c = std::max(glm::dot(p, p) - radius * radius, 0.0);
    return b > 0 && b * b > c ? c / (b + std::sqrt(b * b - c)) : HUGE_VAL;
  };
  return body;
}

/// The blob of the study scenes (geometry/shapes.h): |p| = radius (1 + bump h(p / |p|)), |h| <= 1.
inline AnalyticBody make_blob_body(std::string name, double radius, double bump) {
  struct Bumps {
    double height = 0;
    Vec3 slope{0};  // along the unit sphere
  };
  const auto bumps_at = [](const Vec3& d) {
    static const std::array<std::array<double, 5>, 4> waves{{{3.1, 1.2, -0.7, 0.4, 0.35},
                                                             {-1.3, 3.7, 1.9, 1.7, 0.30},
                                                             {1.1, -2.3, 4.3, 2.9, 0.20},
                                                             {5.3, 2.9, 3.1, 0.8, 0.15}}};
    Bumps result;
    for (const auto& [x, y, z, phase, weight] : waves) {
      const Vec3 frequency(x, y, z);
      const double argument = glm::dot(frequency, d) + phase;
      result.height += weight * std::sin(argument);
      result.slope += weight * std::cos(argument) * frequency;
    }
    result.slope -= glm::dot(result.slope, d) * d;
    return result;
  };
  const auto onto = [=](const Vec3& p) {
    const Vec3 d = glm::normalize(p);
    return radius * (1 + bump * bumps_at(d).height) * d;
  };
  AnalyticBody body;
  body.name = std::move(name);
  body.onto = onto;
  body.normal = [=](const Vec3& p) {
    const double length = glm::length(p);
    const Vec3 d = p / length;
    return glm::normalize(d - (radius / length) * bump * bumps_at(d).slope);
  };
  body.patches = {[=](Vec2 s) {
    const double z = 1 - 2 * s.y, azimuth = 2 * pi * s.x, r = std::sqrt(std::max(0.0, 1 - z * z));
    return onto(Vec3(r * std::cos(azimuth), r * std::sin(azimuth), z));
  }};
  body.boundary = [=](const Vec3& p, const Vec3& w) {
    // Along the ray f = radius (1 + bump h) - |q| bends down by no more than `bend` outside the sphere of
    // radius `core`, all of which is inside: of the waves |h''| <= 22.3 / |q|^2, of the rest 1 / |q|. The
    // root of f + f' s - bend s^2 / 2 is a step that cannot miss the surface, and near it Newton's.
    const double core = 0.9 * (1 - bump) * radius;
    const double bend = 22.3 * bump * radius / (core * core) + 1 / core;
    double t = 0;
    for (int step = 0; step < 500; ++step) {
      const Vec3 q = p + t * w;
      const double length = glm::length(q), along = glm::dot(q, w);
      const double aside = length * length - along * along;  // squared, of the ray from the centre
      if (length <= core * (1 + 1e-9)) {
        t += std::sqrt(std::max(0.0, core * core - aside)) - along + 1e-8 * radius;
        continue;
      }
      const Bumps bumps = bumps_at(q / length);
      const double inside = radius * (1 + bump * bumps.height) - length;
      const double slope = (radius / length) * bump * glm::dot(bumps.slope, w) - along / length;
      // A ray along the surface takes a step at least, or one that a reflection leaves there stays for ever.
      if (step > 0 && inside < 1e-6 * radius && slope < 0) break;
      const double f = std::max(inside, 0.0), root = std::sqrt(slope * slope + 2 * bend * f);
      double forward = slope > 0 ? (slope + root) / bend : 2 * f / (root - slope);
      // The bound holds as far as the core.
      if (along < 0 && aside < core * core)
        forward = std::min(forward, -along - std::sqrt(core * core - aside) + 1e-9 * radius);
      t += std::max(forward, 1e-6 * radius);
    }
    return t;
  };
  return body;
}

}  // namespace alabaster
