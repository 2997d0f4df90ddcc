#include <catch2/catch.hpp>

#include "core/statistics.h"
#include "optics/albedo_walk.h"
#include "optics/half_space_walk.h"

using namespace alabaster;

TEST_CASE("every photon of the analog walk ends in exactly one count") {
  for (const double g : {-0.9, 0.3, 0.95})
    for (const double eta : {1.0, 1.5, 2.5})
      for (const double albedo : {0.0, 0.7, 0.99})
        for (const double thickness : {0.0, 0.5, 5.0}) {
          AlbedoWalkOptions options;
          options.medium = {g, eta};
          options.albedo = albedo;
          options.photons = 2000;
          if (thickness > 0) options.thickness = thickness;
          const AlbedoWalkResult r = walk_at_albedo(options);
          REQUIRE(r.photons == 2000);
          REQUIRE(r.reflected + r.reflected_unscattered + r.transmitted + r.absorbed + r.truncated ==
                  r.photons);
          uint64_t exits = 0;
          for (const uint64_t count : r.exits) exits += count;
          REQUIRE(exits == r.reflected);
          REQUIRE(r.total_reflectance().value + r.transmittance().value + r.absorbed_fraction().value +
                      r.truncated_fraction().value ==
                  Approx(1));
          if (thickness == 0) REQUIRE(r.transmitted + r.reflected_unscattered == 0);
          if (albedo == 0) REQUIRE(r.reflected == 0);
        }
}

TEST_CASE("a slab without absorption gives everything back") {
  AlbedoWalkOptions options;
  options.albedo = 1;
  options.thickness = 3;
  options.photons = 20000;
  const AlbedoWalkResult r = walk_at_albedo(options);
  CHECK(r.absorbed + r.truncated == 0);
  CHECK(r.reflected + r.reflected_unscattered + r.transmitted == r.photons);
}

TEST_CASE("unscattered light through a clear slab follows Fresnel's series") {
  // alpha = 0: of what entered, exp(-t) T / (1 - (F exp(-t))^2) leaves at the far side, F exp(-t) times that
  // on this side.
  AlbedoWalkOptions options;
  options.albedo = 0;
  options.entry = EntryKind::normal;
  options.medium.eta = 2.5;
  options.thickness = 0.4;
  options.photons = 400000;
  const AlbedoWalkResult r = walk_at_albedo(options);
  const double f = fresnel_dielectric(1, 2.5), fade = std::exp(-0.4);
  const double far = fade * (1 - f) / (1 - f * f * fade * fade);
  const Estimate through = r.of_entered(r.transmitted), back = r.of_entered(r.reflected_unscattered);
  CHECK(std::abs(through.value - far) < 4 * through.standard_error);
  CHECK(std::abs(back.value - far * f * fade) < 4 * back.standard_error);
}

TEST_CASE("order by order: entered = left before collision n + reached collision n, in integers") {
  // Reached is counted at the collision itself, left at the boundary: two sides of one balance.
  const int64_t limit = 300;
  const int photons = 20000;
  std::vector<int> reached(limit + 2), left(limit + 2);
  double absorbed = 0, reflected = 0, truncated = 0;
  const double albedo = 0.93;
  Rng rng(17);
  for (int i = 0; i < photons; ++i) {
    Photon photon;
    photon.direction = sample_diffuse_entry(1.5, rng);
    double weight = 1;
    const WalkEnd end = walk(HalfSpace{}, WalkMedium{}, photon, rng, [&](const Photon& p, Rng&) {
      ++reached[static_cast<std::size_t>(p.order)];
      absorbed += weight * (1 - albedo);
      weight *= albedo;
      return p.order < limit;
    });
    if (end == WalkEnd::left) {
      ++left[static_cast<std::size_t>(photon.order)];
      reflected += weight;
    } else {
      truncated += weight;
    }
  }
  int left_before = 0;
  for (std::size_t n = 1; n <= limit; ++n) {
    left_before += left[n - 1];
    REQUIRE(photons == left_before + reached[n]);
  }
  CHECK((absorbed + reflected + truncated) / photons == Approx(1).epsilon(1e-12));
}

TEST_CASE("the order-resolved tally's integers close over all stages") {
  const HalfSpaceWalkOptions options{{0.3, 1.5}, photons_per_chunk, 2, false};
  for (const PathTally& tally : {half_space_tally(options), half_space_tally_scalar(options)}) {
    uint64_t ends = 0;
    for (int stage = 0; stage < WalkStages::count; ++stage)
      ends += tally.exits_of_stage(stage) + tally.stopped(stage);
    CHECK(ends == photons_per_chunk);
    uint64_t by_distance = 0, by_direction = 0;
    for (int group = 0; group < OrderGroups::count; ++group) {
      for (int bin = 0; bin < RadialBins::count; ++bin) by_distance += tally.exits(group, bin);
      for (int bin = 0; bin < PathTally::cosine_bins; ++bin)
        by_direction += tally.exits_by_cosine(group, bin);
    }
    CHECK(by_distance == by_direction);
    // alpha = 1: what left and what is still inside after 2^20 - 1 orders are all that entered.
    CHECK(tally.reflectance_over_albedo(1).value + tally.truncated() == Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("the analog walk per albedo is the oracle of the order-resolved one (z-test, significance 1e-4)") {
  const PathTally tally = half_space_tally({{0.3, 1.5}, 8 * photons_per_chunk, 12, false});
  const std::vector<double> albedos{0.3, 0.8, 0.97, 0.999};
  for (const double albedo : albedos) {
    AlbedoWalkOptions options;
    options.albedo = albedo;
    options.photons = 400000;
    options.seed = 31;
    const AlbedoWalkResult analog = walk_at_albedo(options);
    const std::vector<Estimate> expected = analog.radial_energy();
    const std::vector<Estimate> measured = radial_energy_over_albedo(tally, albedo);
    // Bins of one octave, so that each holds enough photons for a normal distribution.
    int tested = 0;
    for (int octave = 4; octave < 16; ++octave) {
      Estimate a, b;
      for (int i = 0; i < RadialBins::per_octave; ++i) {
        const auto bin = static_cast<std::size_t>(1 + octave * RadialBins::per_octave + i);
        a.value += expected[bin].value, a.standard_error += std::pow(expected[bin].standard_error, 2);
        b.value += albedo * measured[bin].value;
        b.standard_error += std::pow(albedo * measured[bin].standard_error, 2);
      }
      if (a.value * 400000 < 50) continue;
      ++tested;
      const double z = (a.value - b.value) / std::sqrt(a.standard_error + b.standard_error);
      INFO("albedo " << albedo << " octave " << octave << ": " << a.value << " and " << b.value << ", z "
                     << z);
      CHECK(two_sided_normal_p_value(z) > sidak(1e-4, 40));
    }
    CHECK(tested >= 6);
    const Estimate total = tally.reflectance_over_albedo(albedo), a = analog.of_entered(analog.reflected);
    const double z =
        (a.value - albedo * total.value) / std::hypot(a.standard_error, albedo * total.standard_error);
    CHECK(two_sided_normal_p_value(z) > sidak(1e-4, 4));
  }
}

TEST_CASE("standard errors are those of repetition") {
  // 24 independent tallies: their spread against the stated error, by chi-square.
  const std::vector<double> albedos{0.9, 0.9999};
  struct Spread {
    RunningMoments total, far;
    double stated_total = 0, stated_far = 0;
  };
  std::vector<Spread> spreads(albedos.size());
  const int repeats = 24;
  for (int i = 0; i < repeats; ++i) {
    const PathTally tally = half_space_tally({{0.3, 1.5}, 1, static_cast<uint64_t>(100 + i), false});
    for (std::size_t k = 0; k < albedos.size(); ++k) {
      const Estimate total = tally.reflectance_over_albedo(albedos[k]);
      const Estimate bin = radial_energy_over_albedo(tally, albedos[k])[13 * RadialBins::per_octave];
      spreads[k].total.add(total.value);
      spreads[k].far.add(bin.value);
      spreads[k].stated_total += total.standard_error * total.standard_error / repeats;
      spreads[k].stated_far += bin.standard_error * bin.standard_error / repeats;
    }
  }
  for (const Spread& spread : spreads)
    for (const double ratio :
         {spread.total.variance() / spread.stated_total, spread.far.variance() / spread.stated_far}) {
      INFO("variance ratio " << ratio);
      const double p = chi_square_p_value(ratio * (repeats - 1), repeats - 1);
      CHECK(p > 2.5e-5);
      CHECK(p < 1 - 2.5e-5);
    }
}
