#pragma once

#include <cstdint>
#include <string_view>

#include "core/rng.h"
#include "core/vec.h"

namespace alabaster {

/// What a random number decides. Each name is a dimension of its own, so a decision keeps its number when
/// another decision is added before it.
enum class Dimension : uint32_t {
  pixel,
  lens,
  opacity,
  lobe,
  reflection,
  entry_strategy,
  entry_axis,
  entry_channel,
  entry_radius,
  entry_angle,
  entry_hit,
  entry_area,
  light_choice,
  light_point,
  light_lobe,
  diffuse_direction,
  specular_path,
  walk,
  roulette,
};

enum class SamplerKind { sobol, independent };

/// Parses "sobol" or "independent"; throws InputError otherwise.
SamplerKind sampler_kind_from_name(std::string_view name);

/// Sample k of a pixel as a function of (pixel, k, seed) only: the image does not depend on the number of
/// threads, on the order of tiles or on the number of samples asked for.
///
/// Sobol samples are the padded two-dimensional Sobol points, index-shuffled and Owen-scrambled by hashing
/// (Burley 2020, "Practical Hash-based Owen Scrambling"). They come in groups (see sample_group below), each
/// scrambled by itself, so that the variance of a pixel can be estimated from independent parts.
class Sampler {
 public:
  Sampler(SamplerKind kind, uint64_t seed) : kind_(kind), seed_(seed) {}

  /// Begins sample `index` of pixel (x, y).
  void start(int x, int y, uint32_t index);

  /// Uniform in [0, 1). `occurrence` tells repeated decisions of one name apart (bounce, retry).
  double get_1d(Dimension dimension, uint32_t occurrence = 0) const;
  Vec2 get_2d(Dimension dimension, uint32_t occurrence = 0) const;

  /// A stream of its own for walks of unknown length.
  Rng stream(Dimension dimension, uint32_t occurrence = 0) const;

  SamplerKind kind() const { return kind_; }

 private:
  uint32_t shuffled_index(uint32_t seed) const;
  uint64_t dimension_hash(Dimension dimension, uint32_t occurrence) const;

  SamplerKind kind_;
  uint64_t seed_;
  uint64_t group_hash_ = 0;      // pixel, seed and group
  uint64_t sample_hash_ = 0;     // pixel, seed and sample
  uint32_t reversed_index_ = 0;  // of the sample in its group, bits reversed
  uint32_t group_mask_ = 3;
};

/// The scrambling groups of the Sobol sampler: 16 groups of 4 samples, then 16 of 8, 16 of 16, ...: sixteen
/// independent parts of each size are enough for a variance, and the groups grow with the sample count so
/// that stratification is not lost.
struct SampleGroup {
  uint32_t size_class;  // 0: size 4, 1: size 8, ...
  uint32_t group;       // 0..15 within the class
  uint32_t index;       // 0..size-1 within the group
  uint32_t size() const { return 4u << size_class; }
};
SampleGroup sample_group(uint32_t sample_index);

}  // namespace alabaster
