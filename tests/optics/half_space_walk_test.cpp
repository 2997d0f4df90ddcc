#include "optics/half_space_walk.h"

#include <catch2/catch.hpp>

#include "core/parallel.h"
#include "core/statistics.h"

using namespace alabaster;

namespace {

const std::vector<double> albedos{0.1, 0.5, 0.9, 0.99, 0.999, 0.9999};

double z_value(const Estimate& a, const Estimate& b) {
  return (a.value - b.value) / std::hypot(a.standard_error, b.standard_error);
}

}  // namespace

TEST_CASE("order groups tile the orders") {
  for (int group = 0; group < OrderGroups::count; ++group) {
    REQUIRE(OrderGroups::index(OrderGroups::first(group)) == group);
    REQUIRE(OrderGroups::index(OrderGroups::first(group + 1) - 1) == group);
  }
  REQUIRE(OrderGroups::first(OrderGroups::count) == OrderGroups::limit);
  // Stages end where groups end.
  for (int stage = 0; stage < WalkStages::count; ++stage) {
    const int64_t next = WalkStages::limit(stage) + 1;
    REQUIRE((next == OrderGroups::limit || OrderGroups::first(OrderGroups::index(next)) == next));
  }
  // The mean power against its sum.
  const int group = OrderGroups::index(5000);
  double sum = 0;
  for (int64_t n = OrderGroups::first(group); n < OrderGroups::first(group + 1); ++n)
    sum += std::pow(0.9993, static_cast<double>(n - 1));
  CHECK(OrderGroups::mean_power(group, 0.9993) ==
        Approx(sum / static_cast<double>(OrderGroups::width(group))));
}

TEST_CASE("the vectorised walk agrees with the scalar walk (z-test, significance 1e-4 over all albedos)") {
  const std::vector<WalkMedium> media{{0.3, 1.5}, {-0.5, 1.0}};
  for (const auto& [g, eta] : media) {
    HalfSpaceWalkOptions options{{g, eta}, photons_per_chunk, 3, false};
    const PathTally lanes = half_space_tally(options);
    options.seed = 4;
    const PathTally scalar = half_space_tally_scalar(options);
    REQUIRE(lanes.photons() == options.photons);
    REQUIRE(scalar.photons() == options.photons);
    for (const double albedo : albedos) {
      INFO("g " << g << " eta " << eta << " albedo " << albedo);
      const double z = z_value(lanes.reflectance_over_albedo(albedo), scalar.reflectance_over_albedo(albedo));
      CHECK(two_sided_normal_p_value(z) > sidak(1e-4, 12));
    }
  }
}

TEST_CASE("the tally does not depend on the number of threads") {
  const HalfSpaceWalkOptions options{{0.3, 1.5}, 2 * photons_per_chunk, 9, false};
  std::vector<PathTally> tallies;
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    tallies.push_back(half_space_tally(options));
  }
  set_thread_count(0);
  for (const PathTally& tally : tallies)
    for (int group = 0; group < OrderGroups::count; ++group)
      for (int bin = 0; bin < RadialBins::count; ++bin)
        REQUIRE(tally.exits(group, bin) == tallies[0].exits(group, bin));
}
