#include "optics/body_walk.h"

#include <catch2/catch.hpp>

#include "core/statistics.h"

using namespace alabaster;

namespace {

double z_value(const Estimate& a, const Estimate& b) {
  return (a.value - b.value) / std::hypot(a.standard_error, b.standard_error);
}

uint64_t count_exits(const PathTally& tally) {
  uint64_t sum = 0;
  for (int group = 0; group < OrderGroups::count; ++group)
    for (int bin = 0; bin < RadialBins::count; ++bin)
      sum += tally.exits(group, bin) + (tally.has_far_side() ? tally.far_exits(group, bin) : 0);
  return sum;
}

}  // namespace

TEST_CASE("boundary distances of curved bodies: the ray ends on the surface, and never leaves before") {
  Rng rng(3);
  for (const double curvature : {2.0, 0.1, 0.001, 0.0, -0.01, -1.0})
    for (int k = 0; k < 2000; ++k) {
      const CurvedBody body{curvature};
      const Vec3 p(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform());
      if (body.depth(p) <= 0) continue;
      const double z = 2 * rng.uniform() - 1;
      const Vec2 azimuth = sample_azimuth(rng);
      const double r = std::sqrt(1 - z * z);
      const Vec3 w(r * azimuth.x, r * azimuth.y, z);
      const double t = body.boundary_distance(p, w);
      const double end = std::min(t, 100.0);
      for (int i = 1; i < 20; ++i) REQUIRE(body.depth(p + (end * i / 20) * w) >= -1e-9);
      if (!std::isfinite(t)) continue;
      Photon photon{p + t * w, w, 0};
      CHECK(std::abs(body.depth(photon.position)) < 1e-9 * (1 + t * t));
      body.snap(photon);
      CHECK(glm::dot(w, body.outward_normal(photon.position)) >= -1e-6);
    }
}

TEST_CASE("what enters a body leaves it, is stopped or is still inside") {
  for (const WalkBody body : {WalkBody::ball(2), WalkBody::cavity(3), WalkBody::slab(1)}) {
    BodyWalkOptions options;
    options.photons = 40000;
    options.stages.last = 5;
    const PathTally tally = body_tally(body, options);
    uint64_t stopped = 0;
    for (int stage = 0; stage < WalkStages::count; ++stage) stopped += tally.stopped(stage);
    CHECK(tally.photons() == 65536);
    CHECK(count_exits(tally) + stopped == tally.photons());
    // Light is conserved at albedo 1: what left at order 0, later, and what never did.
    double unscattered = 0;
    for (int bin = 0; bin < PathTally::cosine_bins; ++bin)
      unscattered +=
          static_cast<double>(tally.exits_by_cosine(0, bin)) / static_cast<double>(tally.photons());
    CHECK(unscattered + tally.reflectance_over_albedo(1).value + tally.truncated() ==
          Approx(1).epsilon(1e-9));
  }
}

TEST_CASE("a body without curvature is the half-space") {
  // A(0.5) and A(0.9) of the baseline's table, whose own errors are far smaller.
  BodyWalkOptions options;
  options.photons = 200000;
  options.stages.last = 4;
  const PathTally tally = body_tally(WalkBody{}, options);
  for (const auto& [albedo, reflectance] : {std::pair{0.5, 0.02920}, {0.9, 0.18680}}) {
    const Estimate e = tally.reflectance_over_albedo(albedo);
    CHECK(std::abs(albedo * e.value - reflectance) < 4 * albedo * e.standard_error + 1e-4);
  }
}

TEST_CASE("light that balls and cavities return (independent simulations, z-test at 1e-3)") {
  struct Row {
    WalkBody body;
    double albedo, value, error;
  };
  const Row rows[] = {{WalkBody::ball(3), 0.5, 0.0743, 2e-4},     {WalkBody::ball(3), 0.8, 0.2684, 2e-4},
                      {WalkBody::ball(3), 0.95, 0.6483, 2e-4},    {WalkBody::ball(10), 0.5, 0.0355, 2e-4},
                      {WalkBody::ball(10), 0.8, 0.1339, 2e-4},    {WalkBody::ball(10), 0.95, 0.4009, 2e-4},
                      {WalkBody::cavity(10), 0.5, 0.0253, 8e-4},  {WalkBody::cavity(10), 0.8, 0.0846, 8e-4},
                      {WalkBody::cavity(10), 0.95, 0.2186, 8e-4}, {WalkBody::cavity(10), 0.99, 0.3862, 8e-4}};
  const WalkBody* walked = nullptr;
  PathTally tally;
  const double limit = 3.9;  // two-sided 1e-3 over ten rows
  for (const Row& row : rows) {
    if (walked == nullptr || walked->curvature != row.body.curvature) {
      BodyWalkOptions options;
      options.photons = row.body.curvature > 0 ? 600000 : 100000;
      options.stages.last = 5;
      tally = body_tally(row.body, options);
      walked = &row.body;
    }
    const Estimate e = tally.reflectance_over_albedo(row.albedo);
    const double error = std::hypot(row.albedo * e.standard_error, row.error);
    INFO(1 / row.body.curvature << " at " << row.albedo << ": " << row.albedo * e.value << " +- " << error);
    CHECK(std::abs(row.albedo * e.value - row.value) < limit * error);
  }
}

TEST_CASE("which photons are followed how far changes no estimate, and errors are what they say") {
  for (const WalkBody body : {WalkBody::cavity(2), WalkBody::ball(8)}) {
    BodyWalkOptions options;
    options.medium.g = 0.6;
    options.stages.last = 4;
    options.photons = 300000;
    const PathTally plain = body_tally(body, options);
    options.photons = 1;  // a chunk
    options.stages.first_thinning = 3;
    if (body.curvature < 0) options.stages.quartered_from = 1;
    const std::array<double, 3> albedos{0.5, 0.9, 0.99};
    std::array<double, 3> square{}, sum{}, variance{};
    const int repetitions = 8;
    for (int k = 0; k < repetitions; ++k) {
      options.seed = static_cast<uint64_t>(100 + k);
      const PathTally tally = body_tally(body, options);
      for (std::size_t a = 0; a < albedos.size(); ++a) {
        const Estimate e = tally.reflectance_over_albedo(albedos[a]);
        sum[a] += e.value / repetitions;
        variance[a] += e.standard_error * e.standard_error / repetitions;
        square[a] += e.value * e.value / repetitions;
      }
    }
    for (std::size_t a = 0; a < albedos.size(); ++a) {
      INFO(body.curvature << " at " << albedos[a]);
      const Estimate mean{sum[a], std::sqrt(variance[a] / repetitions)};
      CHECK(std::abs(z_value(mean, plain.reflectance_over_albedo(albedos[a]))) < 4.2);  // 2e-4 over all
      // The spread over the seeds: chi-square of 7 degrees between its 1e-4 quantiles.
      const double spread = repetitions * (square[a] - sum[a] * sum[a]) / variance[a];
      CHECK(spread > 0.49);
      CHECK(spread < 29.9);
    }
  }
}

TEST_CASE("the vector lanes agree with the scalar walk in every body (z-tests, 1e-4 over all)") {
  const double limit = 4.9;  // 2 x 4 bodies x 4 albedos
  for (const WalkBody body : {WalkBody::ball(1), WalkBody::ball(8), WalkBody::cavity(2), WalkBody::slab(2)}) {
    BodyWalkOptions options;
    options.photons = 65536;
    options.stages.last = 3;
    const PathTally scalar = body_tally_scalar(body, options);
    options.photons = 262144;
    options.seed = 2;
    const PathTally lanes = body_tally(body, options);
    for (const double albedo : {0.1, 0.5, 0.9, 0.99}) {
      INFO(body.curvature << " " << body.thickness << " at " << albedo);
      CHECK(std::abs(z_value(lanes.reflectance_over_albedo(albedo), scalar.reflectance_over_albedo(albedo))) <
            limit);
      if (!body.is_slab()) continue;
      Estimate far[2];
      for (int k = 0; k < 2; ++k)
        for (const Estimate& e : far_radial_energy_over_albedo(k == 0 ? lanes : scalar, albedo)) {
          far[k].value += e.value;
          far[k].standard_error = std::hypot(far[k].standard_error, e.standard_error);
        }
      CHECK(std::abs(z_value(far[0], far[1])) < limit);
    }
  }
}
