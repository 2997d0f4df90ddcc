#include <algorithm>
#include <cmath>

#include "geometry/geodesic.h"

namespace alabaster {

std::vector<std::optional<double>> Geodesic::distances(const SurfacePoint& from,
                                                       std::span<const SurfacePoint> to) const {
  std::vector<std::optional<double>> result;
  result.reserve(to.size());
  for (const SurfacePoint& target : to) result.push_back(distance(from, target));
  return result;
}

namespace {

/// Methods that start from the straight line and need the surface only to land on it.
class ChordFamily : public GeodesicPath {
 public:
  ChordFamily(const TriangleMesh& mesh, const RayScene& scene, uint32_t object)
      : mesh_(mesh), scene_(scene), object_(object) {}

 protected:
  std::optional<SurfacePoint> on_surface(const Vec3& p) const {
    const auto closest = scene_.closest_point(object_, p);
    if (!closest) return std::nullopt;
    SurfacePoint point = mesh_.surface_point(closest->triangle, closest->barycentric);
    point.object = object_;
    return point;
  }

 private:
  const TriangleMesh& mesh_;
  const RayScene& scene_;
  uint32_t object_;
};

class Chord final : public ChordFamily {
 public:
  using ChordFamily::ChordFamily;
  std::string_view name() const override { return "chord"; }
  std::optional<double> distance(const SurfacePoint& from, const SurfacePoint& to) const override {
    return glm::length(to.position - from.position);
  }
  std::optional<SurfacePoint> between(const SurfacePoint& from, const SurfacePoint& to,
                                      double t) const override {
    return on_surface(glm::mix(from.position, to.position, t));
  }
};

/// The angle between the chord and the tangent planes at its ends, the mean of both.
double mean_tangent_angle(const SurfacePoint& from, const SurfacePoint& to, const Vec3& unit_chord) {
  const auto angle = [&](const SurfacePoint& point) {
    return std::asin(std::min(std::abs(glm::dot(point.shading_normal, unit_chord)), 1.0));
  };
  return 0.5 * (angle(from) + angle(to));
}

class NormalCorrectedChord final : public ChordFamily {
 public:
  using ChordFamily::ChordFamily;
  std::string_view name() const override { return "normal-corrected chord"; }
  std::optional<double> distance(const SurfacePoint& from, const SurfacePoint& to) const override {
    const Vec3 chord = to.position - from.position;
    const double length = glm::length(chord);
    if (!(length > 0)) return 0.0;
    const double angle = mean_tangent_angle(from, to, chord / length);
    return angle > 1e-4 ? length * angle / std::sin(angle) : length;
  }
  std::optional<SurfacePoint> between(const SurfacePoint& from, const SurfacePoint& to,
                                      double t) const override {
    const Vec3 chord = to.position - from.position;
    const double length = glm::length(chord);
    if (!(length > 0)) return from;
    const Vec3 along = chord / length;
    // The arc bulges to the side the chord leaves the surface on: outwards where it dives below.
    const double depth = 0.5 * (glm::dot(to.shading_normal, along) - glm::dot(from.shading_normal, along));
    const double angle = std::copysign(mean_tangent_angle(from, to, along), depth);
    Vec3 up = from.shading_normal + to.shading_normal;
    up -= along * glm::dot(up, along);
    const double up_length = glm::length(up);
    if (std::abs(angle) < 1e-4 || !(up_length > 1e-6))
      return on_surface(glm::mix(from.position, to.position, t));
    // A circle of radius length / (2 sin angle); its arc spans twice the angle.
    const double radius = 0.5 * length / std::sin(angle), phi = (2 * t - 1) * angle;
    return on_surface(0.5 * (from.position + to.position) + radius * std::sin(phi) * along +
                      radius * (std::cos(phi) - std::cos(angle)) * (up / up_length));
  }
};

class ProjectedChord final : public ChordFamily {
 public:
  ProjectedChord(const TriangleMesh& mesh, const RayScene& scene, uint32_t object, int steps)
      : ChordFamily(mesh, scene, object), steps_(std::max(steps, 2)) {}
  std::string_view name() const override { return "projected chord"; }

  std::optional<double> distance(const SurfacePoint& from, const SurfacePoint& to) const override {
    const auto points = polygon(from, to);
    if (!points) return std::nullopt;
    return length_of(*points);
  }

  std::optional<SurfacePoint> between(const SurfacePoint& from, const SurfacePoint& to,
                                      double t) const override {
    const auto points = polygon(from, to);
    if (!points) return std::nullopt;
    double left = t * length_of(*points);
    for (std::size_t i = 1; i < points->size(); ++i) {
      const Vec3 a = (*points)[i - 1].position, b = (*points)[i].position;
      const double length = glm::length(b - a);
      if (left <= length || i + 1 == points->size())
        return on_surface(glm::mix(a, b, length > 0 ? std::min(left / length, 1.0) : 0.0));
      left -= length;
    }
    return from;
  }

 private:
  static double length_of(const std::vector<SurfacePoint>& points) {
    double sum = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      sum += glm::length(points[i].position - points[i - 1].position);
    return sum;
  }

  std::optional<std::vector<SurfacePoint>> polygon(const SurfacePoint& from, const SurfacePoint& to) const {
    const double step = glm::length(to.position - from.position) / steps_;
    std::vector<SurfacePoint> points{from};
    for (int i = 1; i <= steps_; ++i) {
      const auto next =
          i < steps_ ? on_surface(glm::mix(from.position, to.position, static_cast<double>(i) / steps_))
                     : std::optional(to);
      if (!next) return std::nullopt;
      // On a surface steeper than this against the chord, or from one sheet to another.
      if (glm::length(next->position - points.back().position) > longest_step * step) return std::nullopt;
      if (glm::dot(next->geometric_normal, points.back().geometric_normal) < -0.5) return std::nullopt;
      points.push_back(*next);
    }
    return points;
  }

  static constexpr double longest_step = 4;
  int steps_;
};

}  // namespace

std::unique_ptr<GeodesicPath> make_chord(const TriangleMesh& mesh, const RayScene& scene, uint32_t object) {
  return std::make_unique<Chord>(mesh, scene, object);
}

std::unique_ptr<GeodesicPath> make_normal_corrected_chord(const TriangleMesh& mesh, const RayScene& scene,
                                                          uint32_t object) {
  return std::make_unique<NormalCorrectedChord>(mesh, scene, object);
}

std::unique_ptr<GeodesicPath> make_projected_chord(const TriangleMesh& mesh, const RayScene& scene,
                                                   uint32_t object, int steps) {
  return std::make_unique<ProjectedChord>(mesh, scene, object, steps);
}

}  // namespace alabaster
