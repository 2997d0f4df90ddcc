#include <catch2/catch.hpp>
#include <cstdio>
#include <vector>

#include "core/parallel.h"
#include "optics/half_space_walk.h"
#include "optics/mixture_profile.h"
#include "optics/profile_store.h"

using namespace alabaster;

namespace {

template <typename Body>
void time_per_call(const char* name, const Body& body) {
  const int rounds = 200, calls = 4096;
  const double start = cpu_seconds();
  double sum = 0;
  for (int round = 0; round < rounds; ++round)
    for (int i = 0; i < calls; ++i) sum += body(static_cast<std::size_t>(i));
  std::printf("%-36s %8.1f ns (%g)\n", name, (cpu_seconds() - start) / rounds / calls * 1e9, sum);
}

}  // namespace

// build/release/tests/test_optics "[bench]"
TEST_CASE("speed of the photon walk and of the basis", "[.][bench]") {
  set_thread_count(1);
  for (const bool lanes : {true, false}) {
    const HalfSpaceWalkOptions options{{0.3, 1.5}, 4 * photons_per_chunk, 1, false};
    const double start = cpu_seconds();
    const PathTally tally = lanes ? half_space_tally(options) : half_space_tally_scalar(options);
    std::printf("%-36s %8.1f M collisions per CPU second\n", lanes ? "vector lanes" : "scalar",
                1e-6 * static_cast<double>(tally.collisions()) / (cpu_seconds() - start));
  }
  set_thread_count(0);
  Rng rng(1);
  std::vector<Rgb> albedos;
  std::vector<double> distances;
  for (int i = 0; i < 4096; ++i) {
    albedos.emplace_back(rng.uniform(), rng.uniform(), rng.uniform());
    distances.push_back(std::exp2(12 * rng.uniform() - 6));
  }
  const ProfileTable& table = baseline_profile();
  const MixtureProfile mixture(baseline_table());
  time_per_call("table, three channels",
                [&](std::size_t i) { return table.evaluate_over_albedo(albedos[i], distances[i]).g; });
  time_per_call("five exponentials, three channels",
                [&](std::size_t i) { return mixture.evaluate_over_albedo(albedos[i], distances[i]).g; });
  time_per_call("table, pdf", [&](std::size_t i) { return table.pdf(albedos[i].r, distances[i]); });
  time_per_call("table, sample", [&](std::size_t i) { return table.sample(albedos[i].r, albedos[i].g); });
  time_per_call("five exponentials, sample",
                [&](std::size_t i) { return mixture.sample(albedos[i].r, albedos[i].g); });
  time_per_call("std::exp, for scale", [&](std::size_t i) { return std::exp(-distances[i]); });
}
