// The half-space walk order by order, where the statistics are sharp: totals over all orders hide an error of
// some per cent in a single step (a depth after reflection, a length of a flight).

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "optics/half_space_walk.h"
#include "optics/photon_lanes.h"
#include "support/z_test.h"

using namespace alabaster;

namespace {

constexpr int orders = 12;
// Optical distance, edges: most light of few orders leaves between them.
const std::vector<double> distance_edges{0.25, 0.5, 1, 2, 4};
constexpr std::size_t distance_cells = 6;

std::size_t distance_cell(double rho) {
  std::size_t cell = 0;
  while (cell < distance_edges.size() && rho >= distance_edges[cell]) ++cell;
  return cell;
}

using Counts = std::vector<double>;  // [order][distance], orders 1 .. 12

std::size_t cell_of(int64_t order, double rho) {
  return static_cast<std::size_t>(order - 1) * distance_cells + distance_cell(rho);
}

/// The scalar walk, stopped after twelve orders.
Counts scalar_counts(const WalkMedium& medium, uint64_t photons, uint64_t seed) {
  Counts counts(orders * distance_cells);
  Rng rng(seed);
  for (uint64_t i = 0; i < photons; ++i) {
    Photon photon;
    photon.direction = sample_diffuse_entry(medium.eta, rng);
    const WalkEnd end =
        walk(HalfSpace{}, medium, photon, rng, [](const Photon& p, Rng&) { return p.order <= orders; });
    if (end == WalkEnd::left)
      counts[cell_of(photon.order, std::hypot(photon.position.x, photon.position.y))] += 1;
  }
  return counts;
}

Counts lane_counts(const PathTally& tally) {
  Counts counts(orders * distance_cells);
  for (int order = 1; order <= orders; ++order)
    for (int bin = 0; bin < RadialBins::count; ++bin)
      counts[cell_of(order, bin == 0 ? 0 : RadialBins::centre(bin))] +=
          static_cast<double>(tally.exits(OrderGroups::index(order), bin));
  return counts;
}

/// Chi-square of two samples of one distribution, the rest of the photons being a cell of its own.
double two_sample_p_value(const Counts& a, double photons_a, const Counts& b, double photons_b) {
  double statistic = 0, rest_a = photons_a, rest_b = photons_b;
  int cells = 0;
  const auto add = [&](double in_a, double in_b) {
    if (in_a + in_b < 40) return;
    const double ratio = std::sqrt(photons_b / photons_a);
    statistic += std::pow(ratio * in_a - in_b / ratio, 2) / (in_a + in_b);
    ++cells;
  };
  for (std::size_t i = 0; i < a.size(); ++i) {
    add(a[i], b[i]);
    rest_a -= a[i], rest_b -= b[i];
  }
  add(rest_a, rest_b);
  return chi_square_p_value(statistic, cells - 1);
}

}  // namespace

TEST_CASE("order by order and place by place, the vectorised walk is the scalar walk (chi-square, 1e-4)") {
  // Enough photons that a depth 10 % off after a total reflection, a flight 2 % too long, or a cosine 2 % off
  // shows.
  for (const WalkMedium medium : {WalkMedium{0.3, 1.5}, WalkMedium{-0.5, 1.2}}) {
    const PathTally tally = half_space_tally({medium, 8 * photons_per_chunk, 21, false});
    const uint64_t photons = 600000;
    const double p = two_sample_p_value(scalar_counts(medium, photons, 22), static_cast<double>(photons),
                                        lane_counts(tally), static_cast<double>(tally.photons()));
    INFO("g " << medium.g << ", eta " << medium.eta << ", p " << p);
    CHECK(p > sidak(1e-4, 2));
  }
}

TEST_CASE("light that is thrown straight back and forth leaves by Fresnel alone (z-test at 1e-4)") {
  // Partial reflections are rare beside total ones: at eta = 1.5 their share of the light of any order is
  // below a hundredth, and what follows them is seen in no other test. With g close to -1 all flights are of
  // one line, which meets the boundary within the critical cone only. Half the light reaches the surface
  // after its first collision, where 1 - F leaves; of what is reflected the flight goes on below, and half of
  // it comes back after the second collision: E[1 - F] / 2 and E[F (1 - F)] / 4 leave with orders 1 and 2,
  // the mean taken over light that entered.
  const WalkMedium medium{-0.9999, 3};
  double entered = 0, first = 0, second = 0;
  constexpr int steps = 10000;
  for (int i = 0; i < steps; ++i) {
    const double cosine = (i + 0.5) / steps, f = fresnel_dielectric(cosine, medium.eta);
    const double weight = cosine * (1 - f);
    entered += weight;
    first += weight * (1 - f) / 2;
    second += weight * f * (1 - f) / 4;
  }
  const PathTally tally = half_space_tally({medium, 16 * photons_per_chunk, 23, false});
  const auto photons = static_cast<double>(tally.photons());
  for (const auto& [order, share] : {std::pair{1, first / entered}, std::pair{2, second / entered}}) {
    double exits = 0;
    for (int bin = 0; bin < RadialBins::count; ++bin)
      exits += static_cast<double>(tally.exits(OrderGroups::index(order), bin));
    const double deviation = std::sqrt(photons * share * (1 - share));
    INFO("order " << order << ": " << exits / photons << " +- " << deviation / photons << ", exact "
                  << share);
    CHECK(two_sided_normal_p_value((exits - photons * share) / deviation) > sidak(1e-4, 2));
  }
}

TEST_CASE("under uniform light the normal view of both walks is adding-doubling's") {
  // g = 0.3, eta = 1.5, 32 quadrature points: the reflectance at normal incidence (table in
  // published_values_test) without the mirrored 0.04, which by reciprocity is the radiance along the normal
  // under uniform radiance 1.
  const std::vector<std::pair<double, double>> exact{{0.5, 0.02542}, {0.9, 0.17022}, {0.99, 0.51072}};
  const WalkMedium medium;
  const double transmittance = 1 - fresnel_dielectric(1, medium.eta);
  // One photon scores several times, so the error is that of repetition: below one per mille. A depth 10 %
  // too large after every total reflection changes these by 4 per mille only, which is why totals of some
  // 10^5 photons do not see it.
  std::vector<PathTally> tallies;
  for (uint64_t seed = 1; seed <= 32; ++seed)
    tallies.push_back(half_space_tally({medium, photons_per_chunk, 50 + seed, true}));
  for (const auto& [albedo, radiance] : exact) {
    RunningMoments views;
    for (const PathTally& tally : tallies) {
      double sum = 0;
      for (const Estimate& bin : normal_view_energy_over_albedo(tally, albedo, normal_view_score(medium)))
        sum += albedo * bin.value;
      views.add(sum * transmittance);
    }
    const double t = (views.mean() - radiance) / views.standard_error();
    INFO("albedo " << albedo << ": " << views.mean() << " +- " << views.standard_error() << ", exact "
                   << radiance);
    CHECK(student_p_value(t, 31) > sidak(1e-4, 3));
    CHECK(views.standard_error() < 0.005 * radiance);
  }
}
