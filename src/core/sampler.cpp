#include "core/sampler.h"

#include <array>
#include <bit>
#include <string>

#include "core/error.h"

namespace alabaster {

namespace {

uint32_t reverse_bits(uint32_t v) {
  v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
  v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
  v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(v);
}

// Laine-Karras style hash: a bit of the result depends on lower bits only, so on bit-reversed input it is an
// Owen scramble. Constants of Vegdahl's search, quoted by Burley 2020.
uint32_t laine_karras(uint32_t v, uint32_t seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

// Both words at once; they change places, so that the result is the reversal of the second, then the first.
uint64_t reverse_both(uint32_t first, uint32_t second) {
  uint64_t v = (static_cast<uint64_t>(second) << 32) | first;
  v = ((v >> 1) & 0x5555555555555555u) | ((v & 0x5555555555555555u) << 1);
  v = ((v >> 2) & 0x3333333333333333u) | ((v & 0x3333333333333333u) << 2);
  v = ((v >> 4) & 0x0f0f0f0f0f0f0f0fu) | ((v & 0x0f0f0f0f0f0f0f0fu) << 4);
  return __builtin_bswap64(v);
}

// Second coordinate of the two-dimensional Sobol sequence, its bits reversed; the first is the bit reversal
// of the index. The generator matrix is Pascal's triangle modulo 2.
constexpr uint32_t reversed_sobol_second(uint32_t index) {
  uint32_t result = 0;
  for (uint32_t column = 1; index != 0; index >>= 1, column ^= column << 1)
    if (index & 1u) result ^= column;
  return result;
}

constexpr std::array<uint32_t, 64> first_of_sobol_second = [] {
  std::array<uint32_t, 64> table{};
  for (uint32_t i = 0; i < table.size(); ++i) table[i] = reversed_sobol_second(i);
  return table;
}();

double to_unit(uint32_t v) {
  return v * 0x1p-32;
}

}  // namespace

SamplerKind sampler_kind_from_name(std::string_view name) {
  if (name == "sobol") return SamplerKind::sobol;
  if (name == "independent") return SamplerKind::independent;
  throw InputError("sampler '" + std::string(name) + "' is not known; use sobol or independent");
}

SampleGroup sample_group(uint32_t k) {
  // Class c holds the 64 * 2^c samples that follow 64 * (2^c - 1).
  const auto size_class = static_cast<uint32_t>(std::bit_width((k / 64 + 1) / 2));
  const uint32_t offset = k - 64u * ((1u << size_class) - 1u);
  const uint32_t size = 4u << size_class;
  return {size_class, offset / size, offset % size};
}

void Sampler::start(int x, int y, uint32_t index) {
  const uint64_t pixel = (static_cast<uint64_t>(static_cast<uint32_t>(y)) << 32) | static_cast<uint32_t>(x);
  const uint64_t base = hash_combine(seed_, pixel);
  const SampleGroup group = sample_group(index);
  group_hash_ = hash_combine(base, group.size_class * 16 + group.group + 1);
  sample_hash_ = hash_combine(base ^ 0x5851f42d4c957f2dULL, index);
  reversed_index_ = reverse_bits(group.index);
  group_mask_ = group.size() - 1;
}

uint64_t Sampler::dimension_hash(Dimension dimension, uint32_t occurrence) const {
  const uint64_t key = (static_cast<uint64_t>(occurrence) << 32) | static_cast<uint32_t>(dimension);
  return hash_combine(kind_ == SamplerKind::sobol ? group_hash_ : sample_hash_, key);
}

// An Owen scramble of the index. Only the bits within the group: those above would be the same for all its
// samples, and what they add to a Sobol point is drowned by its scramble.
uint32_t Sampler::shuffled_index(uint32_t seed) const {
  return reverse_bits(laine_karras(reversed_index_, seed)) & group_mask_;
}

double Sampler::get_1d(Dimension dimension, uint32_t occurrence) const {
  const uint64_t hash = dimension_hash(dimension, occurrence);
  if (kind_ == SamplerKind::independent) return static_cast<double>(hash >> 11) * 0x1p-53;
  const uint32_t index = shuffled_index(static_cast<uint32_t>(hash));
  return to_unit(reverse_bits(laine_karras(index, static_cast<uint32_t>(hash >> 32))));
}

Vec2 Sampler::get_2d(Dimension dimension, uint32_t occurrence) const {
  const uint64_t hash = dimension_hash(dimension, occurrence);
  const uint64_t more = mix_bits(hash);
  if (kind_ == SamplerKind::independent)
    return {static_cast<double>(hash >> 11) * 0x1p-53, static_cast<double>(more >> 11) * 0x1p-53};
  const uint32_t index = shuffled_index(static_cast<uint32_t>(hash));
  const uint32_t second =
      index < first_of_sobol_second.size() ? first_of_sobol_second[index] : reversed_sobol_second(index);
  const uint64_t both = reverse_both(laine_karras(index, static_cast<uint32_t>(hash >> 32)),
                                     laine_karras(second, static_cast<uint32_t>(more)));
  return {to_unit(static_cast<uint32_t>(both >> 32)), to_unit(static_cast<uint32_t>(both))};
}

Rng Sampler::stream(Dimension dimension, uint32_t occurrence) const {
  return Rng(sample_hash_, (static_cast<uint64_t>(occurrence) << 32) | static_cast<uint32_t>(dimension));
}

}  // namespace alabaster
