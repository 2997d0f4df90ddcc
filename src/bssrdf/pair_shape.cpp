#include "bssrdf/pair_shape.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

namespace {

double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

}  // namespace

PointShape::PointShape(const LocalShape& local, double thickest)
    : normal(local.normal),
      curvature_min(local.curvature_min),
      curvature_max(local.curvature_max),
      inverse_thickness(local.inverse_thickness),
      roughness(local.roughness),
      coarse_distance(0.5 * coarse_radius / thickest_body * thickest) {
  const double half_thickness = 0.5 / std::max(inverse_thickness, 1 / thickest);
  bend_square = 0.5 * (curvature_min * curvature_min + curvature_max * curvature_max);
  sphericity = std::min(bend_square * half_thickness * half_thickness, 1.0);
}

PairShape pair_shape(const Vec3& entry, const PointShape& at_entry, const Vec3& exit,
                     const PointShape& at_exit) {
  const Vec3 chord = entry - exit;
  const double square = length_squared(chord);
  PairShape pair;
  pair.distance = std::sqrt(square);
  pair.bend = std::sqrt(0.5 * (at_entry.bend_square + at_exit.bend_square));
  pair.inverse_thickness = 0.5 * (at_entry.inverse_thickness + at_exit.inverse_thickness);
  // What is a ball but for 2 % is one.
  pair.sphericity = std::min(0.51 * (at_entry.sphericity + at_exit.sphericity), 1.0);
  const double curvature = glm::dot(at_entry.normal - at_exit.normal, chord) / square;
  // Short chords magnify errors of the normals; on opposite sides of a body 2 / thickness is right.
  const double low = std::min({at_entry.curvature_min, at_exit.curvature_min, 0.0});
  const double high = std::max(at_entry.curvature_max, at_exit.curvature_max) + 2 * pair.inverse_thickness;
  pair.curvature = std::clamp(curvature, low, std::max(low, high));
  // On a saddle, a pair along the convex direction sends less than on a ball or a cylinder.
  const double hollow = -0.5 * std::min(at_entry.curvature_min + at_exit.curvature_min, 0.0);
  if (hollow > 0 && pair.curvature > 0) pair.curvature *= 1 - 0.5 * hollow / (pair.curvature + hollow);
  const double turned = 0.5 * (1 - glm::dot(at_entry.normal, at_exit.normal));
  // Two surfaces that face each other more than those of a cavity of their own curvature would: a gap.
  if (curvature < low && turned > 0.6)
    pair.reach = 1 - smooth_step(5 * (low - curvature) * pair.distance) * smooth_step((turned - 0.6) / 0.3);
  // Far away, light is spread over a surface that wrinkles make larger, at both ends alike.
  const double rough = at_entry.roughness + at_exit.roughness;
  if (rough > 0) pair.reach *= std::exp(-0.25 * rough * smooth_step(pair.distance / at_exit.coarse_distance));
  // Of the other side nothing is asked where the normals agree but for some 30 degrees.
  pair.far = std::clamp((turned * turned - 0.005) / 0.99, 0.0, 1.0);
  if (pair.far > 0 && pair.inverse_thickness > 0) {
    const double thickness = 1 / pair.inverse_thickness, across = 0.5 * curvature * square;
    pair.far *= smooth_step(2 * across / thickness);
    pair.separation = std::clamp(across, 0.5 * thickness, 2 * thickness);
    pair.lateral = std::sqrt(std::max(square - pair.separation * pair.separation, 1e-6 * square));
  }
  return pair;
}

}  // namespace alabaster
