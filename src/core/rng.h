#pragma once

#include <array>
#include <cstdint>

namespace alabaster {

/// 64-bit finaliser of MurmurHash3 (variant 13 of Stafford 2011): every input bit reaches every output bit.
constexpr uint64_t mix_bits(uint64_t v) {
  v ^= v >> 30;
  v *= 0xbf58476d1ce4e5b9ULL;
  v ^= v >> 27;
  v *= 0x94d049bb133111ebULL;
  v ^= v >> 31;
  return v;
}

constexpr uint64_t hash_combine(uint64_t a, uint64_t b) {
  return mix_bits(a * 0x9e3779b97f4a7c15ULL + b + 0x632be59bd9b4e019ULL);
}

/// xoshiro256+ (Blackman & Vigna 2018): the stream for long random walks, one per (seed, stream).
class Rng {
 public:
  explicit Rng(uint64_t seed, uint64_t stream = 0) {
    uint64_t x = hash_combine(seed, stream);
    for (uint64_t& word : state_) word = mix_bits(x += 0x9e3779b97f4a7c15ULL);
  }

  uint64_t next() {
    const uint64_t result = state_[0] + state_[3];
    const uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = (state_[3] << 45) | (state_[3] >> 19);
    return result;
  }

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  /// Uniform in (0, 1]: safe as the argument of a logarithm.
  double uniform_positive() { return (static_cast<double>(next() >> 11) + 1) * 0x1p-53; }

 private:
  std::array<uint64_t, 4> state_;
};

}  // namespace alabaster
