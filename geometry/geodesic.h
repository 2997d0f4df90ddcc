#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/half_edge_mesh.h"
#include "geometry/mesh.h"
#include "geometry/ray_scene.h"
#include "geometry/surface_point.h"

namespace alabaster {

/// Length of the shortest way over the surface between two points of one object, approximately.
/// Implementations are interchangeable, thread-safe and differ in cost, accuracy and what they notice; they
/// refer to the mesh, scene and half-edges they were made from, which must outlive them.
class Geodesic {
 public:
  virtual ~Geodesic() = default;
  virtual std::string_view name() const = 0;
  /// m. Nothing where the method sees that it found no way (another component, beyond a gap).
  virtual std::optional<double> distance(const SurfacePoint& from, const SurfacePoint& to) const = 0;
  /// The same for many targets; cheaper for methods that work from one source.
  virtual std::vector<std::optional<double>> distances(const SurfacePoint& from,
                                                       std::span<const SurfacePoint> to) const;
};

/// A method that knows the way as well.
class GeodesicPath : public Geodesic {
 public:
  /// The point at fraction t in [0, 1] of the way.
  virtual std::optional<SurfacePoint> between(const SurfacePoint& from, const SurfacePoint& to,
                                              double t) const = 0;
};

/// The straight line: a lower bound, symmetric, a few nanoseconds. between() carries its points to the
/// surface by closest_point.
std::unique_ptr<GeodesicPath> make_chord(const TriangleMesh& mesh, const RayScene& scene, uint32_t object);

/// c a / sin a with chord c, and a the mean over both ends of the angle between chord and tangent plane
/// (shading normals): exact on spheres up to half the way around. Symmetric, a few nanoseconds. between()
/// carries the points of the arc of that angle to the surface.
std::unique_ptr<GeodesicPath> make_normal_corrected_chord(const TriangleMesh& mesh, const RayScene& scene,
                                                          uint32_t object);

/// The polygon through points of the chord carried to the surface: `steps` closest-point queries. Nothing
/// where it jumps (the chord passes through a thick part or over a gap).
std::unique_ptr<GeodesicPath> make_projected_chord(const TriangleMesh& mesh, const RayScene& scene,
                                                   uint32_t object, int steps = 8);

/// Straightest path over triangles (Polthier & Schmies 1998) from `from` towards `to`: direction and length
/// are corrected until it arrives. Cost: a few times the triangles it crosses. Nothing where it does not
/// arrive: borders, folds in between.
std::unique_ptr<GeodesicPath> make_straightest_path(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges);

/// Shortest way along edges (A*, Hart et al. 1968): an upper bound that does not converge under refinement
/// (10 to 20 % too long on average), symmetric, knows what is not connected.
std::unique_ptr<Geodesic> make_edge_graph(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges);

/// Shortest way over edges and `per_edge` points on each of them (Lanthier, Maheshwari & Sack 1997): an upper
/// bound that converges to the polyhedral distance; with 6 points 0.5 % too long over many edges, 2 % over
/// one. Knows what is not connected. Tenths of a second per source.
std::unique_ptr<Geodesic> make_steiner_graph(const TriangleMesh& mesh, int per_edge = 6);

/// Heat method (Crane, Weischedel & Wardetzky 2013): factored once (memory about 1 kB per vertex), then two
/// back-substitutions per source, whatever the number of targets. First order in the edge length.
std::unique_ptr<Geodesic> make_heat_method(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges);

}  // namespace alabaster
