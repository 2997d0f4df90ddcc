#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/rgb.h"
#include "core/rng.h"
#include "geometry/mesh.h"
#include "geometry/ray_scene.h"
#include "integrators/albedo_cells.h"
#include "integrators/depth_guide.h"
#include "integrators/light_guide.h"
#include "scene/medium.h"
#include "texture/albedo_field.h"

namespace alabaster {

/// Where the albedo of a collision comes from.
enum class WalkAlbedo {
  closest_point,  // the texture's at the closest point of the medium's boundary: the reference
  exit            // the exit point's, everywhere: what production random walks do
};

/// How the closest point is found.
enum class ClosestPointMode {
  cached,  // cells of albedo, corrected at random by exact queries: the same expectation (albedo_cells.h)
  exact    // a query at every collision: the oracle
};

struct VolumeWalkOptions {
  WalkAlbedo albedo = WalkAlbedo::closest_point;
  ClosestPointMode closest_point = ClosestPointMode::cached;
  /// Without, concentrated light is found by walks that happen to leave towards it.
  bool look_for_light = true;
  /// Directions and flights lead towards the surface more often than by chance.
  bool steered = true;
  /// An open mesh counts as the front of a medium that fills all space behind it; without, it is refused.
  bool open_sheets = false;
  /// Paths are cut after this many collisions; what is lost is counted. A guard against endless loops at
  /// albedo 1, not a parameter of quality.
  int64_t max_order = 10'000'000;
};

/// The end of a walk that left the medium.
struct VolumeWalkExit {
  SurfacePoint point;  // where it left; normals outwards
  Vec3 direction{0};   // unit, outside, refracted
  Rgb weight;          // of the path
  int64_t order = 0;   // collisions
};

/// Random walks through the medium of one closed object with a smooth dielectric boundary (docs/theory.md,
/// "Volumetric meaning of a 2.5D texture"). Walks run backwards, from just below a surface point to where
/// light came in; by reciprocity of the boundary and of the phase function that is the same as forwards.
///
/// With a guide, collisions near the surface also look for light: a direction is drawn from the guide and the
/// straight way out that refracts into it is searched for, facet by facet. Of all the ways one walk found,
/// its own exit among them, one is kept in proportion to what it promises. Both ways of leaving are combined
/// by the balance heuristic (docs/volumetric_reference.md). Thread-safe.
class VolumeWalk {
 public:
  /// `boundary` has one flag per material index: whether the medium lies below its triangles; where it is 0
  /// light is absorbed. Everything passed by reference outlives the walk, the guide too; without one only the
  /// walk's own exit counts. `density` (or null) is the share of sigma_t at the closest surface point, in r,
  /// 0 to 1; a varying medium is walked through by null collisions and does without cells and guide.
  VolumeWalk(const RayScene& rays, const TriangleMesh& mesh, uint32_t object, std::vector<uint8_t> boundary,
             const Medium& medium, const AlbedoField& albedo, const VolumeWalkOptions& options,
             const LightGuide* guide = nullptr, const AlbedoField* density = nullptr);

  /// Walks from `start` on the boundary in `direction` (unit, inside). Nothing where the path was absorbed or
  /// ended by Russian roulette. An exit of order 0 is light that never scattered.
  std::optional<VolumeWalkExit> walk(const SurfacePoint& start, const Vec3& direction, Rng& rng) const;

  struct Counts {
    std::atomic<int64_t> collisions{0}, rays{0}, walks{0};
    std::atomic<int64_t> queries{0};  // of collisions, for the closest point
    std::atomic<int64_t> lost{0};     // slipped through a crack between triangles, or longer than max_order
  };
  const Counts& counts() const { return counts_; }
  /// Nothing where every query is exact.
  const AlbedoCells* cells() const { return cells_.get(); }

 private:
  struct Vertex;
  struct Crossing;
  struct Candidate;
  struct State;
  bool advance(State& state, Rng& rng) const;

  void prepare_guides();
  const DepthGuides::Column* choose_guides(const State& state) const;
  void begin_flight(State& state, const Vec3& normal, Rng& rng) const;
  void scatter(State& state, Rng& rng) const;
  void weigh_flight(State& state, double travelled, bool collides) const;
  Rgb steered_density(const SteeredFlight& flight, double travelled, bool collides) const;
  bool collide(State& state, Rng& rng) const;
  bool meet_boundary(State& state, const Hit& hit, Rng& rng) const;

  std::optional<Rgb> albedo(State& state, Rng& rng) const;
  std::optional<Rgb> exact_albedo(State& state, double reach, uint32_t guess) const;
  std::optional<SurfacePoint> closest_point(State& state, double reach, uint32_t guess) const;

  // Light that is looked for: light_search.cpp.
  void look_for_light(State& state, Rng& rng) const;
  std::optional<Crossing> search(const Vertex& vertex, const Vec3& outside, int64_t& rays) const;
  Rgb weight_of(const Vertex& vertex, const Crossing& crossing, double light_pdf) const;
  Rgb weight_of_exit(State& state) const;
  std::optional<VolumeWalkExit> choose_exit(State& state, Rng& rng) const;

  const RayScene& rays_;
  const TriangleMesh& mesh_;
  uint32_t object_;
  std::vector<uint8_t> boundary_;
  Medium medium_;
  Rgb sigma_t_;
  bool grey_;
  double slack_;  // m: what single precision may be off by
  const AlbedoField& albedo_;
  VolumeWalkOptions options_;
  const LightGuide* guide_;
  const AlbedoField* density_;
  std::unique_ptr<AlbedoCells> cells_;
  std::optional<DepthGuides> depth_guides_;
  double darkness_ = 0;  // of the whole surface, see DepthGuides
  mutable Counts counts_;
};

}  // namespace alabaster
