#include "optics/body_walk.h"

#include <mutex>

#include "core/parallel.h"
#include "optics/fast_math.h"
#include "optics/lane_state.h"

// As photon_lanes.cpp, for bodies that photons can cross: a flight that meets the boundary ends there, and
// what follows (Fresnel's decision, reflections until the next collision) is scalar.

namespace alabaster {

namespace {

// Photons of a chunk, the unit in which they are shared out among stages: enough for some to reach the last.
uint64_t chunk_photons(const BodyWalkOptions& options) {
  return uint64_t{1} << (15 + options.stages.first_thinning);
}
constexpr float never = 1e30f;

// The lanes' boundary distances: CurvedBody's and Slab's in single precision, without branches.
struct CurvedLanes {
  float curvature;
  explicit CurvedLanes(const CurvedBody& body) : curvature(static_cast<float>(body.curvature)) {}
  float boundary_distance(float x, float y, float z, float u, float v, float w) const {
    const float k = curvature;
    const float depth = 2 * z - k * (x * x + y * y + z * z), f = depth > 0 ? depth : 0.f;
    const float slope = w - k * (x * u + y * v + z * w);
    const float square = slope * slope + k * f;
    const float root = std::sqrt(square > 0 ? square : 0.f);
    const bool inwards = slope > 0;
    const float numerator = inwards ? slope + root : f, denominator = inwards ? k : root - slope;
    const float distance = numerator / denominator;
    return (square < 0) | (inwards & !(k > 0)) ? never : distance;
  }
};
struct SlabLanes {
  float thickness;
  explicit SlabLanes(const Slab& body) : thickness(static_cast<float>(body.thickness)) {}
  float boundary_distance(float, float, float z, float, float, float w) const {
    const float distance = (w < 0 ? z : z - thickness) / -w;
    return w * w > 0 ? distance : never;
  }
};

void tally_exit(const CurvedBody&, PathTally& tally, const Photon& p, double cosine) {
  tally.add_exit(p.order, length_squared(p.position), cosine);
}
void tally_exit(const Slab& slab, PathTally& tally, const Photon& p, double cosine) {
  const double lateral = p.position.x * p.position.x + p.position.y * p.position.y;
  if (p.position.z > 0.5 * slab.thickness)
    tally.add_far_exit(p.order, lateral, cosine);
  else
    tally.add_exit(p.order, lateral, cosine);
}

template <typename Body, typename Lanes>
class BodyLaneWalk : LaneState {
 public:
  BodyLaneWalk(const Body& body, const BodyWalkOptions& options, uint64_t stream, PathTally& tally)
      : LaneState(options.seed, stream), body_(body), lanes_(body), medium_(options.medium), tally_(tally) {
    for (int stage = 0; stage < WalkStages::count; ++stage)
      to_launch_[stage] = options.stages.photons(stage, chunk_photons(options));
  }

  void run() {
    while (active_ < lane_count && launch(active_)) ++active_;
    while (active_ > 0) {
      const int lanes = (active_ + vector_width - 1) / vector_width * vector_width;
      scatter(static_cast<float>(medium_.g), lanes);
      fly(lanes);
      settle([this](int i) { return ends(i); }, [this](int i) { return launch(i); },
             [this](int from, int to) {
               move(from, to);
               crosses_[to] = crosses_[from];
             });
    }
  }

 private:
  // Puts the next photon that collides at all at its first collision. The longest stages come first, so that
  // a few long walks do not trail after all others have ended. False when none is left.
  bool launch(int lane) {
    for (;;) {
      while (stage_ >= 0 && to_launch_[stage_] == 0) --stage_;
      if (stage_ < 0) return false;
      --to_launch_[stage_];
      Photon photon;
      photon.direction = sample_diffuse_entry(medium_.eta, rng_);
      stage_of_[lane] = stage_;
      limit_[lane] = static_cast<int32_t>(WalkStages::limit(stage_));
      if (!reaches_collision(photon)) continue;
      store(lane, photon);
      return true;
    }
  }

  void fly(int lanes) {
    for (int i = 0; i < lanes; ++i) {
      const float flight = -fast_log(lane_rng_.uniform(i));
      const float boundary = lanes_.boundary_distance(x_[i], y_[i], z_[i], u_[i], v_[i], w_[i]);
      const bool crosses = boundary < flight;
      const float step = crosses ? boundary : flight;
      x_[i] += step * u_[i];
      y_[i] += step * v_[i];
      z_[i] += step * w_[i];
      order_[i] += static_cast<int32_t>(!crosses);
      crosses_[i] = static_cast<int32_t>(crosses);
      marked_[i] = static_cast<int32_t>(crosses) | static_cast<int32_t>(order_[i] > limit_[i]);
    }
  }

  bool ends(int i) {
    if (crosses_[i]) {
      Photon photon;
      photon.position = {x_[i], y_[i], z_[i]};
      photon.direction = glm::normalize(Vec3(u_[i], v_[i], w_[i]));
      photon.order = order_[i];
      body_.snap(photon);
      if (!reflects(photon) || !reaches_collision(photon)) return true;
      store(i, photon);
    }
    if (order_[i] <= limit_[i]) return false;
    tally_.add_stopped(stage_of_[i]);
    tally_.add_collisions(static_cast<uint64_t>(limit_[i]));
    return true;
  }

  // A photon on the boundary: reflected back, or out and tallied.
  bool reflects(Photon& photon) {
    const Vec3 normal = body_.outward_normal(photon.position);
    const double along = glm::dot(photon.direction, normal);
    const double cosine = std::min(std::abs(along), 1.0);
    if (reflected_inside(cosine, medium_.eta, rng_)) {
      photon.direction -= 2 * along * normal;
      return true;
    }
    tally_exit(body_, tally_, photon, refracted_cosine(cosine, 1 / medium_.eta));
    tally_.add_collisions(static_cast<uint64_t>(photon.order));
    return false;
  }

  // From a launch or a reflection to the next collision, by way of any number of reflections. False when the
  // photon left.
  bool reaches_collision(Photon& photon) {
    for (;;) {
      const double flight = sample_free_flight(rng_);
      const double boundary = body_.boundary_distance(photon.position, photon.direction);
      if (flight < boundary) {
        photon.position += flight * photon.direction;
        ++photon.order;
        return true;
      }
      photon.position += boundary * photon.direction;
      body_.snap(photon);
      if (!reflects(photon)) return false;
    }
  }

  void store(int lane, const Photon& photon) {
    x_[lane] = static_cast<float>(photon.position.x);
    y_[lane] = static_cast<float>(photon.position.y);
    z_[lane] = static_cast<float>(photon.position.z);
    u_[lane] = static_cast<float>(photon.direction.x);
    v_[lane] = static_cast<float>(photon.direction.y);
    w_[lane] = static_cast<float>(photon.direction.z);
    order_[lane] = static_cast<int32_t>(photon.order);
  }

  Body body_;
  Lanes lanes_;
  WalkMedium medium_;
  PathTally& tally_;
  uint64_t to_launch_[WalkStages::count];
  int stage_ = WalkStages::count - 1;
  alignas(64) int32_t crosses_[lane_count]{};
};

template <typename Body>
void walk_photon(const Body& body, const WalkMedium& medium, int stage, Rng& rng, PathTally& tally) {
  Photon photon;
  photon.direction = sample_diffuse_entry(medium.eta, rng);
  const int64_t limit = WalkStages::limit(stage);
  const WalkEnd end =
      walk(body, medium, photon, rng, [limit](const Photon& p, Rng&) { return p.order <= limit; });
  tally.add_collisions(static_cast<uint64_t>(std::min(photon.order, limit)));
  if (end == WalkEnd::stopped) return tally.add_stopped(stage);
  const double cosine = glm::dot(photon.direction, body.outward_normal(photon.position));
  tally_exit(body, tally, photon, refracted_cosine(std::clamp(cosine, 0.0, 1.0), 1 / medium.eta));
}

template <typename Chunk>
PathTally tally_chunks(const WalkBody& body, const BodyWalkOptions& options, const Chunk& chunk) {
  const uint64_t photons = chunk_photons(options), chunks = (options.photons + photons - 1) / photons;
  PathTally total(false, body.is_slab());
  std::mutex mutex;
  parallel_for(chunks, (chunks + 7) / 8, [&](std::size_t begin, std::size_t end) {
    PathTally part(false, body.is_slab());
    for (std::size_t c = begin; c < end; ++c) chunk(c, part);
    const std::lock_guard<std::mutex> lock(mutex);
    total.merge(part);
  });
  return total;
}

}  // namespace

PathTally body_tally(const WalkBody& body, const BodyWalkOptions& options) {
  return tally_chunks(body, options, [&](uint64_t chunk, PathTally& tally) {
    if (body.is_slab())
      BodyLaneWalk<Slab, SlabLanes>(Slab{body.thickness}, options, chunk, tally).run();
    else
      BodyLaneWalk<CurvedBody, CurvedLanes>(CurvedBody{body.curvature}, options, chunk, tally).run();
  });
}

PathTally body_tally_scalar(const WalkBody& body, const BodyWalkOptions& options) {
  return tally_chunks(body, options, [&](uint64_t chunk, PathTally& tally) {
    Rng rng(options.seed, chunk);
    for (int stage = 0; stage < WalkStages::count; ++stage)
      for (uint64_t i = options.stages.photons(stage, chunk_photons(options)); i > 0; --i)
        if (body.is_slab())
          walk_photon(Slab{body.thickness}, options.medium, stage, rng, tally);
        else
          walk_photon(CurvedBody{body.curvature}, options.medium, stage, rng, tally);
  });
}

}  // namespace alabaster
