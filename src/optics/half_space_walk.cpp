#include "optics/half_space_walk.h"

#include <mutex>

#include "core/parallel.h"
#include "optics/photon_lanes.h"

namespace alabaster {

namespace {

template <typename Chunk>
PathTally tally_chunks(const HalfSpaceWalkOptions& options, const std::function<void(double)>& progress,
                       const Chunk& chunk) {
  const uint64_t chunks = (options.photons + photons_per_chunk - 1) / photons_per_chunk;
  PathTally total(options.normal_view);
  std::mutex mutex;
  uint64_t done = 0;
  parallel_for(chunks, 1, [&](std::size_t begin, std::size_t end) {
    PathTally part(options.normal_view);
    for (std::size_t c = begin; c < end; ++c) chunk(c, part);
    const std::lock_guard<std::mutex> lock(mutex);
    total.merge(part);  // integers: the order of merging does not matter
    done += end - begin;
    if (progress) progress(static_cast<double>(done) / static_cast<double>(chunks));
  });
  return total;
}

void walk_photon(const WalkMedium& medium, int stage, Rng& rng, PathTally& tally) {
  Photon photon;
  photon.direction = sample_diffuse_entry(medium.eta, rng);
  const int64_t limit = WalkStages::limit(stage);
  const WalkEnd end =
      walk(HalfSpace{}, medium, photon, rng, [limit](const Photon& p, Rng&) { return p.order <= limit; });
  tally.add_collisions(static_cast<uint64_t>(photon.order));
  if (end == WalkEnd::stopped) return tally.add_stopped(stage);
  const double x = photon.position.x, y = photon.position.y;
  tally.add_exit(photon.order, x * x + y * y, refracted_cosine(-photon.direction.z, 1 / medium.eta));
}

}  // namespace

PathTally half_space_tally_scalar(const HalfSpaceWalkOptions& options) {
  return tally_chunks(options, {}, [&](uint64_t chunk, PathTally& tally) {
    Rng rng(options.seed, chunk);
    for (int stage = 0; stage < WalkStages::count; ++stage)
      for (uint64_t i = WalkStages().photons(stage, photons_per_chunk); i > 0; --i)
        walk_photon(options.medium, stage, rng, tally);
  });
}

PathTally half_space_tally(const HalfSpaceWalkOptions& options, const std::function<void(double)>& progress) {
  return tally_chunks(options, progress, [&](uint64_t chunk, PathTally& tally) {
    walk_in_lanes(options.medium, options.seed, chunk, photons_per_chunk, tally);
  });
}

}  // namespace alabaster
