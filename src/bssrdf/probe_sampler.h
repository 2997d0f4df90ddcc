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
};

/// Random numbers of one draw, uniform in [0, 1).
struct EntryRandom {
  Vec2 choice{0};  // x: strategy, axis, component of the radius; y: far part of the chord, hit
  Vec2 disk{0};    // radius and angle, or the point of the area strategy
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
      int level;       // of the distance table; -1: a disk for light that crosses the body
      double sigma_t;  // 1/m; of the disk the inverse of its radius
      double probability;
      double reach;          // share of the distribution within the object's sphere
      double density_scale;  // what its density is multiplied by
    };
    /// A probe direction, seen from which the object's bounding sphere is a circle.
    struct Axis {
      Vec3 direction;  // unit
      Vec3 to_circle;  // to the circle's centre, perpendicular to the direction, m
      double centre;   // m: length of that
    };
    BssrdfPoint point;
    std::array<Axis, 3> axes;
    std::array<Component, 7> components;
    int component_count = 0;
    double near_limit = 0;  // m: beyond it along the chord, only some probes look
    Rgb typical;            // the albedo that draws are aimed at
  };
  /// Nothing where no light can leave, because the albedo is 0.
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
  std::span<Candidate> draw(const Exit& exit, const EntryRandom& u) const;
  EntrySample finish(const Exit& exit, const Candidate& candidate, double factor) const;
  Rgb typical_albedo(const BssrdfPoint& exit) const;
  /// Returns the share of light that crosses the body.
  double add_components(Exit& exit, const Rgb& typical) const;
  void add_body_light(Exit& exit, double share) const;
  double importance(const Exit& exit, const Candidate& candidate, double distance) const;
  double component_pdf(const Exit::Component& component, double radius) const;
  double component_cdf(const Exit::Component& component, double radius) const;
  double component_radius(const Exit::Component& component, double u) const;
  double radius_density(const Exit& exit, double radius) const;
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
