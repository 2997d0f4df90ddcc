#include "study/planar_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/rng.h"
#include "integrators/planar_volume.h"

namespace alabaster {

double evaluations_per_second(const PlanarModel& model, double seconds) {
  constexpr int pairs_in_a_round = 4096;
  Rng rng(1);
  std::vector<std::pair<BssrdfPoint, Vec2>> pairs;
  for (int i = 0; i < pairs_in_a_round; ++i) {
    const PlanarView& view = model.scene().view;
    const Vec2 exit = view.centre + view.size * (Vec2(rng.uniform(), rng.uniform()) - 0.5);
    pairs.emplace_back(model.exit(exit), model.scene().light.sample({rng.uniform(), rng.uniform()}));
  }
  double sum = 0;
  int rounds = 0;
  const double start = cpu_seconds();
  while (cpu_seconds() - start < seconds || rounds < 2) {
    for (const auto& [exit, entry] : pairs) sum += model.bssrdf().evaluate(model.point(entry), exit).r;
    ++rounds;
  }
  const double spent = cpu_seconds() - start;
  return sum >= 0 ? pairs_in_a_round * rounds / spent : 0;  // the sum keeps the work from being left out
}

namespace {

double to_two_percent(double noise, double seconds) {
  return seconds * noise * noise / (0.02 * 0.02);
}

}  // namespace

PlanarSpeed measure_planar_speed(const PlanarScene& scene, const ProfileTable& profile, uint64_t seed) {
  PlanarSpeed speed;
  speed.scene = scene.name;
  for (const char* name : {"homogeneous", "factorized", "aggregate", "aggregate:mc64", "composite",
                           "composite:symmetric", "composite:order1"}) {
    const PlanarMethod method = parse_planar_method(name);
    if (scene.light.shape == PlanarLight::Shape::plane) break;  // has no area to draw entries from
    speed.evaluations.emplace_back(
        name, evaluations_per_second(PlanarModel(scene, method.model, profile, method.options)));
  }
  for (const char* name : {"composite:uniform", "composite:profile", "composite:mis", "composite"}) {
    const TimedImage image = render_planar(scene, parse_planar_method(name), profile, 64, seed);
    speed.seconds_to_2.emplace_back(name, to_two_percent(noise_of(image.image), image.cpu_seconds));
  }
  const auto reference = [&](PlanarEstimator estimator, uint64_t paths) {
    PlanarVolume volume(scene, {estimator, seed});
    volume.run(paths);
    return to_two_percent(volume.noise(), volume.cpu_seconds());
  };
  const PlanarEstimator cheapest = cheapest_estimator(scene);
  const bool lattice = cheapest == PlanarEstimator::lattice;
  speed.reference_seconds_to_2 = reference(lattice ? PlanarEstimator::from_light : cheapest, 500'000);
  if (lattice) speed.lattice_seconds_to_2 = reference(PlanarEstimator::lattice, 10'000'000);
  return speed;
}

double energy_ratio(const ProfileTable& profile, double local, double between, bool order1_apart) {
  // S / alpha of order 1 alone: its limit as alpha -> 0.
  constexpr double small = 1e-4;
  const double once = order1_apart ? profile.reflectance(small) / small : 0;
  const double over_albedo = profile.reflectance(between) / between;
  const double energy = between * once + local * local / between * (over_albedo - once);
  return energy / profile.reflectance(local);
}

Chart energy_chart(const ProfileTable& profile) {
  Chart chart{"Energy of eq. 2 where both ends are brighter than what lies between",
              "albedo between entry and exit, alpha_t",
              "returned light / that of the ends' albedo everywhere",
              true,
              true,
              {}};
  for (const bool order1_apart : {false, true})
    for (const double local : {0.3, 0.6, 0.95}) {
      ChartSeries series{fmt::format("{}, ends {}", order1_apart ? "order 1 apart" : "eq. 2", local), {}, {}};
      series.points = false;
      for (double t = 0.01; t < 1; t *= 1.1) {
        series.x.push_back(t);
        series.y.push_back(energy_ratio(profile, local, t, order1_apart));
      }
      chart.series.push_back(std::move(series));
    }
  return chart;
}

EnergyExcess energy_excess(const PlanarModel& model, const ProfileTable& profile, uint64_t seed) {
  constexpr int pairs = 20'000;
  const PlanarView& view = model.scene().view;
  const Rgb sigma_t = model.scene().medium.sigma_t(), brightest = model.bssrdf().medium().albedo->max();
  Rng rng(seed);
  EnergyExcess excess;
  double exceeded = 0, seen = 0;
  for (int i = 0; i < pairs; ++i) {
    const BssrdfPoint exit =
        model.point(view.centre + view.size * (Vec2(rng.uniform(), rng.uniform()) - 0.5));
    const double distance = profile.sample(brightest.mean(), rng.uniform()) / sigma_t.mean();
    const double angle = 2 * pi * rng.uniform();
    const Vec2 place = Vec2(exit.surface.position) + distance * Vec2(std::cos(angle), std::sin(angle));
    const Rgb value = model.bssrdf().evaluate(model.point(place), exit);
    for (int c = 0; c < 3; ++c) {
      const double bound = sigma_t[c] * sigma_t[c] * profile.evaluate(brightest[c], sigma_t[c] * distance);
      if (!(bound > 0)) continue;
      ++seen;
      const double ratio = value[c] / bound;
      if (ratio <= 1.001) continue;  // rounding of albedos apart
      ++exceeded;
      excess.mean += ratio;
      excess.worst = std::max(excess.worst, ratio);
    }
  }
  excess.share = seen > 0 ? exceeded / seen : 0;
  excess.mean = exceeded > 0 ? excess.mean / exceeded : 0;
  return excess;
}

}  // namespace alabaster
