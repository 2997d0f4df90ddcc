#include "bssrdf/placements.h"

#include <algorithm>
#include <cmath>

#include "core/frame.h"

namespace alabaster {
namespace {

/// Unit vector in the surface, perpendicular to the chord.
Vec3 sideways(const SurfacePoint& entry, const SurfacePoint& exit) {
  const Vec3 side =
      glm::cross(entry.geometric_normal + exit.geometric_normal, exit.position - entry.position);
  const double length = glm::length(side);
  return length > 0 ? side / length : Vec3(0);
}

bool needs_sideways(std::span<const KernelTap> taps) {
  return std::any_of(taps.begin(), taps.end(), [](const KernelTap& tap) { return tap.across != 0; });
}

/// The same map in the frame of the tangent plane whose first axis is the gradient of u: lower triangular.
/// Up to this share of the distance from an end, within one chart, the end's tangent plane is close enough to
/// the surface: a Gaussian there is at least as wide as it is far from the end.
constexpr double tangent_reach = 2.0 / 7 + 1e-9;

Mat2 jacobian(const UvAtlas& atlas, uint32_t triangle) {
  const auto& [u, v] = atlas.gradients(triangle);
  const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v);
  if (!(uu > 0)) return {0, 0, 0, std::sqrt(vv)};
  const double along = std::sqrt(uu);
  return {along, uv / along, 0, std::sqrt(std::max(vv - uv * uv / uu, 0.0))};
}

}  // namespace

void PlanarPlacement::place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
                            std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const {
  Vec2 side_uv{0};
  if (needs_sideways(taps)) {
    const Vec3 side = Frame(exit.geometric_normal).to_local(sideways(entry, exit));
    side_uv = uv_from_surface_ * Vec2(side.x, side.y);
  }
  for (std::size_t k = 0; k < taps.size(); ++k) {
    KernelFootprint& footprint = footprints[k];
    footprint.uv = entry.uv + taps[k].along * (exit.uv - entry.uv) + taps[k].across * distance * side_uv;
    footprint.sigma = taps[k].sigma * distance;
    footprint.uv_from_surface = uv_from_surface_;
  }
}

KernelFootprint PlanarPlacement::around(const SurfacePoint& point, double sigma) const {
  return {point.uv, point.barycentric, point.triangle, sigma, uv_from_surface_};
}

ProjectedChordPlacement::ProjectedChordPlacement(const TriangleMesh& mesh, const UvAtlas& atlas,
                                                 const RayScene& rays, uint32_t object, double tolerance)
    : mesh_(mesh), atlas_(atlas), rays_(rays), object_(object), tolerance_(tolerance) {}

bool ProjectedChordPlacement::interpolates(const SurfacePoint& entry, const SurfacePoint& exit) const {
  if (tolerance_ < 0 || atlas_.empty() || atlas_.chart(entry.triangle) != atlas_.chart(exit.triangle))
    return false;
  const Vec3 chord = exit.position - entry.position;
  const Vec2 difference = exit.uv - entry.uv;
  const Vec2 from_entry = atlas_.uv_from_surface(entry.triangle, chord);
  const Vec2 from_exit = atlas_.uv_from_surface(exit.triangle, chord);
  const double allowed = tolerance_ * tolerance_ * glm::dot(difference, difference);
  const Vec2 entry_error = from_entry - difference, exit_error = from_exit - difference;
  return glm::dot(entry_error, entry_error) <= allowed && glm::dot(exit_error, exit_error) <= allowed;
}

void ProjectedChordPlacement::place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
                                    std::span<const KernelTap> taps,
                                    std::span<KernelFootprint> footprints) const {
  if (!interpolates(entry, exit)) return place_by_queries(entry, exit, distance, taps, footprints);
  const Mat2 at_entry = jacobian(atlas_, entry.triangle);
  const Mat2 at_exit = exit.triangle == entry.triangle ? at_entry : jacobian(atlas_, exit.triangle);
  const Vec3 chord = exit.position - entry.position;
  const Vec2 difference = exit.uv - entry.uv;
  const Vec2 excess_at_entry = atlas_.uv_from_surface(entry.triangle, chord) - difference;
  const Vec2 excess_at_exit = atlas_.uv_from_surface(exit.triangle, chord) - difference;
  const Vec3 side = needs_sideways(taps) ? sideways(entry, exit) : Vec3(0);
  for (std::size_t k = 0; k < taps.size(); ++k) {
    const double t = taps[k].along, s = 1 - t;
    const bool nearer_exit = t > 0.5;
    const SurfacePoint& end = nearer_exit ? exit : entry;
    KernelFootprint& footprint = footprints[k];
    // Hermite's cubic as the straight line and what the end slopes bend it by.
    footprint.uv = entry.uv + t * difference + (t * s) * (s * excess_at_entry - t * excess_at_exit);
    if (taps[k].across != 0)
      footprint.uv += taps[k].across * distance * atlas_.uv_from_surface(end.triangle, side);
    footprint.barycentric = end.barycentric;
    footprint.triangle = end.triangle;
    footprint.sigma = taps[k].sigma * distance;
    footprint.uv_from_surface = nearer_exit ? at_exit : at_entry;
  }
}

void ProjectedChordPlacement::place_by_queries(const SurfacePoint& entry, const SurfacePoint& exit,
                                               double distance, std::span<const KernelTap> taps,
                                               std::span<KernelFootprint> footprints) const {
  const Vec3 chord = exit.position - entry.position;
  const Vec3 side = needs_sideways(taps) ? sideways(entry, exit) : Vec3(0);
  const bool one_chart =
      tolerance_ >= 0 && !atlas_.empty() && atlas_.chart(entry.triangle) == atlas_.chart(exit.triangle);
  for (std::size_t k = 0; k < taps.size(); ++k) {
    const KernelTap& tap = taps[k];
    const Vec3 wanted = entry.position + tap.along * chord + tap.across * distance * side;
    if (one_chart && std::min(tap.along, 1 - tap.along) <= tangent_reach) {
      const SurfacePoint& end = tap.along > 0.5 ? exit : entry;
      footprints[k] = around(end, tap.sigma * distance);
      footprints[k].uv += atlas_.uv_from_surface(end.triangle, wanted - end.position);
      continue;
    }
    // Both ends lie on the surface, so it is no farther than the nearer of them, and mostly much closer;
    // float coordinates need a margin.
    const SurfacePoint& end = tap.along > 0.5 ? exit : entry;
    const double margin = 1e-5 * glm::length(wanted), bound = glm::distance(wanted, end.position);
    auto closest = rays_.closest_point(object_, wanted, 0.2 * bound + margin);
    if (!closest) closest = rays_.closest_point(object_, wanted, 1.001 * bound + margin);
    const uint32_t triangle = closest ? closest->triangle : end.triangle;
    const Vec2 barycentric = closest ? closest->barycentric : end.barycentric;
    footprints[k] = around(mesh_.surface_point(triangle, barycentric), tap.sigma * distance);
  }
}

KernelFootprint ProjectedChordPlacement::around(const SurfacePoint& point, double sigma) const {
  const Mat2 uv_from_surface = atlas_.empty() ? Mat2(0.0) : jacobian(atlas_, point.triangle);
  return {point.uv, point.barycentric, point.triangle, sigma, uv_from_surface};
}

}  // namespace alabaster
