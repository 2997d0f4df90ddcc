#include "integrators/light_disk_sampler.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "core/statistics.h"
#include "support/analytic_profile.h"

using namespace alabaster;

namespace {

const DistanceTable& table() {
  static const DistanceTable distances{AnalyticProfile()};
  return distances;
}

constexpr double radius = 1.3, sigma_t = 2;
// Exits at the centre, inside, just inside and outside the edge, and afar; in radii.
const std::vector<double> offsets{0, 0.4, 0.93, 0.9999, 1.0001, 1.1, 2, 7};

constexpr int angle_cells = 16, distance_cells = 6;

int cell_of(const LightDiskSampler::View& view, const LightDiskSampler::Place& p) {
  const double a = 0.5 + 0.5 * p.angle / view.widest;
  const double d = (p.distance - p.nearest) / (p.farthest - p.nearest);
  return std::min(static_cast<int>(a * angle_cells), angle_cells - 1) * distance_cells +
         std::min(static_cast<int>(d * distance_cells), distance_cells - 1);
}

/// The probability of each cell by quadrature of pdf().
std::vector<double> expected_cells(const LightDiskSampler& sampler, const LightDiskSampler::View& view,
                                   int level) {
  std::vector<double> expected(angle_cells * distance_cells);
  constexpr int angles = angle_cells * 64, distances = distance_cells * 128;
  for (int i = 0; i < angles; ++i) {
    const double angle = ((i + 0.5) / angles * 2 - 1) * view.widest;
    const Vec2 direction =
        sampler.displacement(view, {angle, Vec2(std::cos(angle), std::sin(angle)), 1, 0, 0});
    // The chord, from a place that is surely on it: the middle one when it crosses, else close by.
    const double probe = view.offset > radius ? view.offset * std::cos(angle) : 1e-9;
    const auto chord = sampler.place(view, probe * direction);
    if (!chord) continue;
    const double step = (chord->farthest - chord->nearest) / distances;
    for (int k = 0; k < distances; ++k) {
      auto place = *chord;
      place.distance = chord->nearest + (k + 0.5) * step;
      expected[static_cast<std::size_t>(cell_of(view, place))] +=
          sampler.pdf(view, level, place) * place.distance * step * (2 * view.widest / angles);
    }
  }
  return expected;
}

}  // namespace

TEST_CASE("entries within the light are drawn from the density that pdf() states (chi-square, 1 %)") {
  const LightDiskSampler sampler(table(), sigma_t, radius);
  constexpr int count = 40000;
  const std::vector<double> albedos{0.3, 0.95, 0.9999};
  for (const double offset : offsets)
    for (const double albedo : albedos) {
      const int level = DistanceTable::level(albedo);
      const auto view = sampler.view(Vec2(0.6, -0.8) * (offset * radius));
      const std::vector<double> expected = expected_cells(sampler, view, level);
      std::vector<double> observed(expected.size());
      Rng rng(3, static_cast<uint64_t>(level) + static_cast<uint64_t>(1e6 * offset));
      int missing = 0;
      for (int i = 0; i < count; ++i) {
        const auto place = sampler.sample(view, level, {rng.uniform(), rng.uniform()});
        if (!place) {
          ++missing;
          continue;
        }
        observed[static_cast<std::size_t>(cell_of(view, *place))] += 1;
      }
      double statistic = 0, total = 0, rest_expected = 0, rest_observed = 0;
      int cells = 0;
      for (std::size_t k = 0; k < expected.size(); ++k) {
        total += expected[k];
        if (expected[k] * count < 10) {
          rest_expected += expected[k] * count;
          rest_observed += observed[k];
          continue;
        }
        ++cells;
        statistic += std::pow(observed[k] - expected[k] * count, 2) / (expected[k] * count);
      }
      if (rest_expected >= 10) {
        ++cells;
        statistic += std::pow(rest_observed - rest_expected, 2) / rest_expected;
      }
      CAPTURE(offset, albedo, statistic, cells, total);
      CHECK(total == Approx(1).epsilon(2e-3));
      CHECK(missing == 0);
      CHECK(chi_square_p_value(statistic, cells - 1) >
            sidak(0.01, static_cast<double>(offsets.size() * albedos.size())));
    }
}

TEST_CASE("places within the light and displacements are inverse, and none lies outside") {
  const LightDiskSampler sampler(table(), sigma_t, radius);
  Rng rng(5);
  for (const double offset : offsets) {
    const Vec2 to_centre = Vec2(-0.28, 0.96) * (offset * radius);
    const auto view = sampler.view(to_centre);
    for (int i = 0; i < 2000; ++i) {
      const auto place = sampler.sample(view, 20, {rng.uniform(), rng.uniform()});
      REQUIRE(place);
      const Vec2 there = sampler.displacement(view, *place);
      CHECK(glm::distance(there, to_centre) <= radius * (1 + 1e-9));
      if (place->farthest - place->nearest < 1e-6) continue;  // grazes: rounding decides
      const auto back = sampler.place(view, there);
      REQUIRE(back);
      CHECK(sampler.pdf(view, 20, *back) == Approx(sampler.pdf(view, 20, *place)).epsilon(1e-6));
    }
  }
  const auto view = sampler.view(Vec2(0.5, 0));
  CHECK_FALSE(sampler.place(view, Vec2(0)));
  const auto from_outside = sampler.view(Vec2(3, 0));
  CHECK_FALSE(sampler.place(from_outside, Vec2(0, 1)));
}

TEST_CASE("under a constant texture entries weigh nearly the same, wherever the exit is") {
  // Profile over density: constant but for the tables' steps. Uniform sampling by area spreads without bound.
  const AnalyticProfile profile;
  const LightDiskSampler sampler(table(), sigma_t, radius);
  const double albedo = 0.9;
  const int level = DistanceTable::level(albedo);
  Rng rng(6);
  for (const double offset : offsets) {
    const auto view = sampler.view(Vec2(offset * radius, 0));
    double sum = 0, squares = 0;
    constexpr int count = 4000;
    for (int i = 0; i < count; ++i) {
      const auto place = sampler.sample(view, level, {rng.uniform(), rng.uniform()});
      REQUIRE(place);
      const double s = profile.evaluate_over_albedo(albedo, sigma_t * place->distance);
      const double weight = s / sampler.pdf(view, level, *place);
      sum += weight;
      squares += weight * weight;
    }
    CAPTURE(offset);
    CHECK(std::sqrt(squares / count - std::pow(sum / count, 2)) < 0.25 * sum / count);
  }
}
