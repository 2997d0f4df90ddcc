#include "optics/albedo_walk.h"

#include <mutex>

#include "core/parallel.h"
#include "optics/half_space_walk.h"

namespace alabaster {

namespace {

Vec3 enter(const AlbedoWalkOptions& options, Rng& rng) {
  if (options.entry == EntryKind::diffuse) return sample_diffuse_entry(options.medium.eta, rng);
  const double outside = options.entry == EntryKind::normal ? 1 : options.entry_cosine;
  const double cosine = refracted_cosine(outside, options.medium.eta);
  return {std::sqrt(std::max(0.0, 1 - cosine * cosine)), 0, cosine};
}

double specular_reflectance(const AlbedoWalkOptions& options) {
  if (options.entry == EntryKind::diffuse) return 1 - diffuse_transmittance(options.medium.eta);
  return fresnel_dielectric(options.entry == EntryKind::normal ? 1 : options.entry_cosine,
                            options.medium.eta);
}

template <typename Shape>
void walk_one(const Shape& shape, const AlbedoWalkOptions& options, Rng& rng, AlbedoWalkResult& result) {
  Photon photon;
  photon.direction = enter(options, rng);
  bool absorbed = false;
  const WalkEnd end = walk(shape, options.medium, photon, rng, [&](const Photon& p, Rng& random) {
    ++result.collisions;
    if (options.albedo < 1 && random.uniform() >= options.albedo) {
      absorbed = true;
      ++result.absorbed;
      return false;
    }
    return p.order < OrderGroups::limit;
  });
  if (end == WalkEnd::stopped) {
    if (!absorbed) ++result.truncated;
  } else if (photon.direction.z > 0) {
    ++result.transmitted;
  } else if (photon.order == 0) {
    ++result.reflected_unscattered;
  } else {
    ++result.reflected;
    const double x = photon.position.x, y = photon.position.y;
    ++result.exits[static_cast<std::size_t>(RadialBins::index_of_square(x * x + y * y))];
  }
}

}  // namespace

Estimate AlbedoWalkResult::of_entered(uint64_t count) const {
  const auto n = static_cast<double>(photons);
  const double p = static_cast<double>(count) / n;
  return {p, std::sqrt(p * (1 - p) / n)};
}

Estimate AlbedoWalkResult::of_incident(uint64_t count) const {
  const Estimate entered = of_entered(count);
  return {(1 - specular) * entered.value, (1 - specular) * entered.standard_error};
}

Estimate AlbedoWalkResult::total_reflectance() const {
  const Estimate back = reflectance();
  return {specular + back.value, back.standard_error};
}

std::vector<Estimate> AlbedoWalkResult::radial_energy() const {
  std::vector<Estimate> energy;
  for (const uint64_t count : exits) energy.push_back(of_entered(count));
  return energy;
}

void AlbedoWalkResult::merge(const AlbedoWalkResult& other) {
  photons += other.photons;
  reflected_unscattered += other.reflected_unscattered;
  reflected += other.reflected;
  transmitted += other.transmitted;
  absorbed += other.absorbed;
  truncated += other.truncated;
  collisions += other.collisions;
  for (std::size_t i = 0; i < exits.size(); ++i) exits[i] += other.exits[i];
}

AlbedoWalkResult walk_at_albedo(const AlbedoWalkOptions& options) {
  AlbedoWalkResult total;
  std::mutex mutex;
  parallel_for(options.photons, photons_per_chunk, [&](std::size_t begin, std::size_t end) {
    Rng rng(options.seed, begin / photons_per_chunk);
    AlbedoWalkResult part;
    part.photons = end - begin;
    for (std::size_t i = begin; i < end; ++i) {
      if (options.thickness)
        walk_one(Slab{*options.thickness}, options, rng, part);
      else
        walk_one(HalfSpace{}, options, rng, part);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    total.merge(part);
  });
  total.specular = specular_reflectance(options);
  return total;
}

}  // namespace alabaster
