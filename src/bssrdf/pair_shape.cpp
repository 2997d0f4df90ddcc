#include "bssrdf/pair_shape.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

PointShape::PointShape(const LocalShape& local, double thickest)
    : normal(local.normal),
      curvature_min(local.curvature_min),
      curvature_max(local.curvature_max),
      inverse_thickness(local.inverse_thickness) {
  const double half_thickness = 0.5 / std::max(inverse_thickness, 1 / thickest);
  const double square = 0.5 * (curvature_min * curvature_min + curvature_max * curvature_max);
  sphericity = std::min(square * half_thickness * half_thickness, 1.0);
}

PairShape pair_shape(const Vec3& entry, const PointShape& at_entry, const Vec3& exit,
                     const PointShape& at_exit) {
  const Vec3 chord = entry - exit;
  const double square = length_squared(chord);
  PairShape pair;
  pair.distance = glm::distance(entry, exit);
  pair.inverse_thickness = 0.5 * (at_entry.inverse_thickness + at_exit.inverse_thickness);
  pair.sphericity = 0.5 * (at_entry.sphericity + at_exit.sphericity);
  const double curvature = glm::dot(at_entry.normal - at_exit.normal, chord) / square;
  // Short chords magnify errors of the normals; on opposite sides of a body 2 / thickness is right.
  const double low = std::min(at_entry.curvature_min, at_exit.curvature_min);
  const double high = std::max(at_entry.curvature_max, at_exit.curvature_max) + 2 * pair.inverse_thickness;
  pair.curvature = std::clamp(curvature, std::min(low, high), high);
  const double turned = std::clamp(0.5 * (1 - glm::dot(at_entry.normal, at_exit.normal)), 0.0, 1.0);
  pair.far = turned * turned;
  const double across = 0.5 * pair.curvature * pair.distance;
  pair.lateral = pair.distance * std::sqrt(std::max(0.0, 1 - across * across));
  return pair;
}

}  // namespace alabaster
