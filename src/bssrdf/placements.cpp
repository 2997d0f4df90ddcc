#include "bssrdf/placements.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/error.h"
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

/// Metres to UV in the frame of the tangent plane whose first axis is the gradient of u: lower triangular.
Mat2 jacobian(const UvAtlas& atlas, uint32_t triangle) {
  const auto& [u, v] = atlas.gradients(triangle);
  const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v);
  if (!(uu > 0)) return {0, 0, 0, std::sqrt(vv)};
  const double along = std::sqrt(uu);
  return {along, uv / along, 0, std::sqrt(std::max(vv - uv * uv / uu, 0.0))};
}

/// A footprint on the mesh itself.
KernelFootprint footprint_at(const PlacementBody& body, const SurfacePoint& point, double sigma) {
  const Mat2 uv_from_surface = body.atlas->empty() ? Mat2(0.0) : jacobian(*body.atlas, point.triangle);
  return {point.uv, point.barycentric, point.triangle, sigma, uv_from_surface, point.position};
}

/// The point of the surface closest to `wanted`, which is not much farther from it than `end`.
SurfacePoint on_surface(const PlacementBody& body, const Vec3& wanted, const SurfacePoint& end) {
  // Mostly much closer; float coordinates need a margin.
  const double margin = 1e-5 * glm::length(wanted), bound = glm::distance(wanted, end.position);
  auto closest = body.rays->closest_point(body.object, wanted, 0.2 * bound + margin);
  if (!closest) closest = body.rays->closest_point(body.object, wanted, 1.001 * bound + margin);
  return closest ? body.mesh->surface_point(closest->triangle, closest->barycentric) : end;
}

/// Barycentric coordinates of a point in the plane of a triangle, outside it as well.
Vec2 plane_barycentric(const TriangleMesh& mesh, uint32_t triangle, const Vec3& p) {
  const Index3& c = mesh.corners[triangle];
  const Vec3 a = mesh.positions[c[0]], ab = mesh.positions[c[1]] - a, ac = mesh.positions[c[2]] - a,
             ap = p - a;
  const double bb = glm::dot(ab, ab), bc = glm::dot(ab, ac), cc = glm::dot(ac, ac);
  const double pb = glm::dot(ap, ab), pc = glm::dot(ap, ac), determinant = bb * cc - bc * bc;
  if (!(determinant > 0)) return Vec2(1.0 / 3);
  return Vec2(cc * pb - bc * pc, bb * pc - bc * pb) / determinant;
}

/// The same, moved in the point's tangent plane.
KernelFootprint footprint_beside(const PlacementBody& body, const SurfacePoint& point, double sigma,
                                 const Vec3& offset) {
  KernelFootprint f = footprint_at(body, point, sigma);
  if (offset == Vec3(0)) return f;
  f.position += offset;
  if (sigma >= body.by_position_from) return f;
  if (body.atlas->empty() || body.mesh->uv_sets.size() > 1)
    f.barycentric = plane_barycentric(*body.mesh, point.triangle, f.position);
  if (!body.atlas->empty()) f.uv += body.atlas->uv_from_surface(point.triangle, offset);
  return f;
}

/// Taps at most this many deviations from the nearer end may lie in its tangent plane.
constexpr double tangent_reach = 1.05;

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

KernelFootprint PlanarPlacement::around(const SurfacePoint& point, double sigma, const Vec3& offset) const {
  const Frame frame(point.geometric_normal);
  const Vec2 within(glm::dot(offset, frame.tangent), glm::dot(offset, frame.bitangent));
  return {point.uv + uv_from_surface_ * within, point.barycentric, point.triangle, sigma, uv_from_surface_};
}

/// How UV runs between two points of one chart: straight, and what the end slopes bend it by.
struct ChordPlacement::UvPair {
  double trust = 0;
  Vec2 difference{0}, excess_at_entry{0}, excess_at_exit{0};
};

ChordPlacement::UvPair ChordPlacement::uv_pair(const SurfacePoint& entry, const SurfacePoint& exit) const {
  UvPair pair;
  const UvAtlas& atlas = *body_.atlas;
  if (atlas.empty() || atlas.chart(entry.triangle) != atlas.chart(exit.triangle)) return pair;
  const Vec3 chord = exit.position - entry.position;
  pair.difference = exit.uv - entry.uv;
  pair.excess_at_entry = atlas.uv_from_surface(entry.triangle, chord) - pair.difference;
  pair.excess_at_exit = atlas.uv_from_surface(exit.triangle, chord) - pair.difference;
  const double error = std::max(glm::dot(pair.excess_at_entry, pair.excess_at_entry),
                                glm::dot(pair.excess_at_exit, pair.excess_at_exit));
  const double length = glm::dot(pair.difference, pair.difference);
  constexpr double full = full_trust * full_trust, none = no_trust * no_trust;
  if (error <= full * length)
    pair.trust = 1;
  else if (error < none * length)
    pair.trust = (none - error / length) / (none - full);
  return pair;
}

double ChordPlacement::trust(const SurfacePoint& entry, const SurfacePoint& exit) const {
  return uv_pair(entry, exit).trust;
}

Vec3 ChordPlacement::Way::point(const KernelTap& tap) const {
  const double t = tap.along, s = 1 - t;
  return entry.position + t * chord + (t * s) * (s * bend_at_entry - t * bend_at_exit) +
         (tap.across * distance) * side;
}

void ChordPlacement::place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
                           std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const {
  Way way{entry, exit, distance, exit.position - entry.position};
  if (needs_sideways(taps)) way.side = sideways(entry, exit);
  place_along(way, taps, footprints);
}

void ChordPlacement::place_along(const Way& way, std::span<const KernelTap> taps,
                                 std::span<KernelFootprint> footprints) const {
  std::optional<UvPair> pair;
  for (std::size_t k = 0; k < taps.size(); ++k) {
    KernelFootprint& footprint = footprints[k];
    footprint.position = way.point(taps[k]);
    footprint.sigma = taps[k].sigma * way.distance;
    footprint.triangle = (taps[k].along > 0.5 ? way.exit : way.entry).triangle;
    if (footprint.sigma >= body_.by_position_from) continue;
    if (!pair) pair = uv_pair(way.entry, way.exit);
    place_in_uv(way, *pair, taps[k], footprint);
  }
}

void ChordPlacement::place_in_uv(const Way& way, const UvPair& pair, const KernelTap& tap,
                                 KernelFootprint& f) const {
  const UvAtlas& atlas = *body_.atlas;
  const double t = tap.along, s = 1 - t;
  const SurfacePoint& end = t > 0.5 ? way.exit : way.entry;
  const bool near_end = std::min(t, s) <= tangent_reach * tap.sigma;
  if (pair.trust == 0 && !near_end) {
    f = footprint_at(body_, on_surface(body_, f.position, end), f.sigma);
    return;
  }
  const Vec3 offset = f.position - end.position;
  f.barycentric = end.barycentric;
  if (atlas.empty() || body_.mesh->uv_sets.size() > 1)
    f.barycentric = plane_barycentric(*body_.mesh, end.triangle, f.position);
  if (atlas.empty()) return;
  f.uv_from_surface = jacobian(atlas, end.triangle);
  Vec2 cubic{0}, tangent{0};
  if (pair.trust > 0) {
    cubic =
        way.entry.uv + t * pair.difference + (t * s) * (s * pair.excess_at_entry - t * pair.excess_at_exit);
    if (tap.across != 0) cubic += tap.across * way.distance * atlas.uv_from_surface(end.triangle, way.side);
  }
  if (pair.trust < 1) tangent = end.uv + atlas.uv_from_surface(end.triangle, offset);
  const double trust = near_end ? pair.trust : 1;
  f.uv = trust == 1 ? cubic : tangent + trust * (cubic - tangent);
}

KernelFootprint ChordPlacement::around(const SurfacePoint& point, double sigma, const Vec3& offset) const {
  return footprint_beside(body_, point, sigma, offset);
}

void ArcPlacement::place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
                         std::span<const KernelTap> taps, std::span<KernelFootprint> footprints) const {
  Way way{entry, exit, distance, exit.position - entry.position};
  const double at_entry = glm::dot(entry.shading_normal, way.chord),
               at_exit = glm::dot(exit.shading_normal, way.chord);
  way.bend_at_entry = -at_entry * entry.shading_normal;
  way.bend_at_exit = -at_exit * exit.shading_normal;
  const double angle = 0.5 * (std::asin(std::min(std::abs(at_entry) / distance, 1.0)) +
                              std::asin(std::min(std::abs(at_exit) / distance, 1.0)));
  if (angle > 1e-4) way.distance = distance * angle / std::sin(angle);
  if (needs_sideways(taps)) way.side = sideways(entry, exit);
  place_along(way, taps, footprints);
}

void ProjectedChordPlacement::place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
                                    std::span<const KernelTap> taps,
                                    std::span<KernelFootprint> footprints) const {
  const Vec3 chord = exit.position - entry.position;
  const Vec3 side = needs_sideways(taps) ? sideways(entry, exit) : Vec3(0);
  for (std::size_t k = 0; k < taps.size(); ++k) {
    const KernelTap& tap = taps[k];
    const Vec3 wanted = entry.position + tap.along * chord + tap.across * distance * side;
    footprints[k] =
        around(on_surface(body_, wanted, tap.along > 0.5 ? exit : entry), tap.sigma * distance, Vec3(0));
  }
}

KernelFootprint ProjectedChordPlacement::around(const SurfacePoint& point, double sigma,
                                                const Vec3& offset) const {
  return footprint_beside(body_, point, sigma, offset);
}

StraightestPlacement::StraightestPlacement(const PlacementBody& body)
    : body_(body),
      otherwise_(body),
      half_edges_(std::make_unique<HalfEdgeMesh>(*body.mesh)),
      path_(make_straightest_path(*body.mesh, *half_edges_)) {}

StraightestPlacement::~StraightestPlacement() = default;

void StraightestPlacement::place(const SurfacePoint& entry, const SurfacePoint& exit, double distance,
                                 std::span<const KernelTap> taps,
                                 std::span<KernelFootprint> footprints) const {
  const auto length = path_->distance(entry, exit);
  if (!length || needs_sideways(taps)) return otherwise_.place(entry, exit, distance, taps, footprints);
  for (std::size_t k = 0; k < taps.size(); ++k) {
    const auto point = path_->between(entry, exit, taps[k].along);
    footprints[k] = around(point                 ? *point
                           : taps[k].along > 0.5 ? exit
                                                 : entry,
                           taps[k].sigma * *length, Vec3(0));
  }
}

KernelFootprint StraightestPlacement::around(const SurfacePoint& point, double sigma,
                                             const Vec3& offset) const {
  return footprint_beside(body_, point, sigma, offset);
}

const std::vector<std::string>& placement_names() {
  static const std::vector<std::string> names{"chord", "arc", "projected-chord", "straightest"};
  return names;
}

std::unique_ptr<KernelPlacement> make_placement(std::string_view name, const PlacementBody& body) {
  if (name == "chord") return std::make_unique<ChordPlacement>(body);
  if (name == "arc") return std::make_unique<ArcPlacement>(body);
  if (name == "projected-chord") return std::make_unique<ProjectedChordPlacement>(body);
  if (name == "straightest") return std::make_unique<StraightestPlacement>(body);
  throw InputError("placement '" + std::string(name) +
                   "' is not known; use chord, arc, projected-chord or straightest");
}

}  // namespace alabaster
