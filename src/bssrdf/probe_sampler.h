#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bssrdf/area_sampler.h"
#include "bssrdf/body_light.h"
#include "bssrdf/bssrdf.h"
#include "bssrdf/expected_light.h"
#include "core/sampler.h"
#include "geometry/mesh.h"
#include "geometry/ray_scene.h"

namespace alabaster {

/// The surface that light may enter through: those triangles of one object that bound the exit's medium.
struct ProbeTarget {
  const RayScene* rays = nullptr;
  const TriangleMesh* mesh = nullptr;
  uint32_t object = 0;  // the mesh's id in `rays`
  /// One flag per material index of the mesh: whether it bounds this medium. Empty: all do.
  std::vector<uint8_t> material_in_medium;
  /// What entries may expect, where that is known: those in the dark are followed more seldom. Null: all
  /// alike.
  const ExpectedLight* light = nullptr;
};

/// Random numbers of one draw, uniform in [0, 1).
struct EntryRandom {
  Vec2 choice{0};   // x: strategy, axis, component of the radius; y: far part of the chord
  Vec2 disk{0};     // radius and angle, or the point of the area strategy
  double pick = 0;  // which of the hits, and whether it is followed
};

/// Where light may have entered, with the weight that makes sums of weight * E(entry) unbiased for the
/// integral of S_V(entry, exit) E(entry) over the surface.
struct EntrySample {
  BssrdfPoint point;
  Rgb weight;
  double density = 0;  // expected number of entries per square metre of a draw, all strategies
};

/// A chord to be searched for entries.
struct Probe {
  Ray ray;  // unit direction, from 0 to t_max
};

/// Draws entry points for an exit: a probe ray along one of three axes through a disk around the exit, whose
/// radius follows the profile, or a point uniform by area. Every strategy's density is known at every point
/// of the surface, so all are combined by the balance heuristic (Veach 1997), and the density is positive
/// wherever S_V is. docs/probe_sampling.md has the reasons and the figures. Thread-safe; no heap allocation
/// per draw once a thread's hit list has grown.
class ProbeSampler {
 public:
  /// `model` and what `target` points to outlive the sampler.
  ProbeSampler(const Bssrdf& model, ProbeTarget target);

  /// What draws need of an exit, computed once.
  struct Exit {
    /// Radii for one channel at one albedo.
    struct Component {
      int level;       // of the distance table
      double sigma_t;  // 1/m
      double probability;
      double reach;          // share of the distribution within the object's sphere
      double density_scale;  // what its density is multiplied by
      double profile_scale;  // the same where the half-space's profile is meant
    };
    /// A probe direction, seen from which the object's bounding sphere is a circle.
    struct Axis {
      Vec3 direction;  // unit
      Vec3 to_circle;  // to the circle's centre, perpendicular to the direction, m
      double centre;   // m: length of that
    };
    /// Light that crosses a thin body comes from straight behind: probes about the exit's own normal, within
    /// a disk as wide as the body is thick.
    struct Crossing {
      double probability = 0;
      std::array<Axis, 3> axes;
      double inverse_radius = 0;  // 1/m
      double reach = 1;           // as a component's
      double near_limit = 0;
    };
    BssrdfPoint point;
    std::array<Axis, 3> axes;
    std::array<Component, 6> components;
    int component_count = 0;
    int probes = 1;      // that one entry is chosen from, at most 2
    bool aimed = false;  // whether that choice knows of light's aim
    Crossing crossing;
    double near_limit = 0;   // m: beyond it along the chord, only some probes look
    Rgb typical;             // the albedo that draws are aimed at
    ShapeChannel shape;      // factors at its mean, for the shape basis
    double mean_light = 0;   // at the exit, over all normals
    double usual_light = 1;  // that entries are expected to get, over that mean
  };
  /// Asks memory for what prepare() will read of an exit on that triangle.
  void fetch(uint32_t triangle) const;
  /// Nothing where no light can leave, because the albedo is 0. For exits that know their viewer, entries are
  /// chosen with light's aim in mind (Bssrdf::aim).
  std::optional<Exit> prepare(const BssrdfPoint& exit) const;

  /// Chooses a probe without tracing it; `choice` in [0, 1) picks axis and component. Nothing when the chord
  /// misses the object's bounding sphere.
  std::optional<Probe> choose(const Exit& exit, Vec2 choice, Vec2 disk) const;
  /// Expected number of entries per square metre at `entry` of one draw, all strategies summed.
  double density(const Exit& exit, const SurfacePoint& entry) const;

  /// Draws ONE entry among all hits of the probe, so that one shadow ray serves it. Nothing when there is
  /// none: then the estimate is 0.
  std::optional<EntrySample> sample_entry(const BssrdfPoint& exit, const EntryRandom& u) const;
  /// The same with the sampler's dimensions; `occurrence` tells draws for one pixel sample apart.
  std::optional<EntrySample> sample_entry(const BssrdfPoint& exit, const Sampler& sampler,
                                          uint32_t occurrence = 0) const;
  /// All entries of one draw. Where they are more than `entries` holds, a random part of them, weighted up.
  /// Returns how many were filled.
  std::size_t sample_entries(const BssrdfPoint& exit, const EntryRandom& u,
                             std::span<EntrySample> entries) const;

  const Bssrdf& model() const { return model_; }

 private:
  struct Candidate;
  void draw(const Exit& exit, const EntryRandom& u, std::vector<Candidate>& candidates) const;
  EntrySample finish(const Exit& exit, const Candidate& candidate, double factor) const;
  Rgb typical_albedo(const BssrdfPoint& exit) const;
  /// Whether entries around are worth very different amounts, so that a choice among more of them pays.
  bool varied(const Exit& exit, const Vec3& facing) const;
  Exit::Axis axis(const Exit& exit, const Vec3& direction) const;
  void add_components(Exit& exit) const;
  void add_channel(Exit& exit, int channel, double share) const;
  void add_crossing(Exit& exit) const;
  double importance(const Exit& exit, const Candidate& candidate, double distance) const;
  /// What light's aim makes of an entry there, as far as that may be expected; never 0.
  double expected_aim(const Exit& exit, const Candidate& candidate, const PairShape& pair) const;
  double radius_density(const Exit& exit, double radius) const;
  struct Part;
  static Part near_part(const Exit& exit, double radius);
  static Part near_part(const Exit::Crossing& crossing, double radius);
  std::optional<Probe> chord(const Exit& exit, const Exit::Axis& axis, double radius, double turn,
                             const Part& part) const;
  double half_angle(const Exit::Axis& axis, double radius) const;
  bool in_medium(uint32_t triangle) const;

  const Bssrdf& model_;
  ProbeTarget target_;
  AreaSampler area_;
  std::vector<Vec3f> facing_;            // per triangle: what the axes are tilted against
  std::optional<BodyLight> body_light_;  // for the shape basis
  // Per triangle: its typical albedo once it was asked for, packed; empty where the model's changes at once.
  mutable std::vector<std::atomic<uint64_t>> typical_;
  Vec3 centre_{0};  // of a sphere around the object
  double radius_ = 0;
  std::array<int, 3> brightest_level_{};                            // per channel
  std::array<double, DistanceTable::level_count> near_distance_{};  // optical
};

}  // namespace alabaster
