// Figures of docs/planar_laboratory.md: build/release/tests/test_bench "[planar]". Only ratios are asserted.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/parallel.h"
#include "integrators/planar_volume.h"
#include "study/planar_figures.h"
#include "study/planar_scene_file.h"
#include "study/planar_to_noise.h"

using namespace alabaster;

namespace {

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// |estimate / truth - 1| of the radiance at a point, over seeds.
std::vector<double> relative_errors(const PlanarIntegrator& integrator, const BssrdfPoint& exit, double truth,
                                    int samples) {
  std::vector<double> errors;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    Sampler sampler(SamplerKind::sobol, seed);
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
      sampler.start(0, 0, static_cast<uint32_t>(i));
      sum += integrator.radiance(exit, sampler).r;
    }
    errors.push_back(std::abs(sum / samples / truth - 1));
  }
  return errors;
}

double truth_at(const PlanarIntegrator& integrator, const BssrdfPoint& exit) {
  double sum = 0;
  constexpr int seeds = 16, samples = 4096;
  for (uint64_t seed = 1001; seed <= 1000 + seeds; ++seed) {
    Sampler sampler(SamplerKind::sobol, seed);
    for (uint32_t i = 0; i < samples; ++i) {
      sampler.start(0, 0, i);
      sum += integrator.radiance(exit, sampler).r;
    }
  }
  return sum / (seeds * samples);
}

}  // namespace

TEST_CASE("evaluations of S_V per second and core", "[bench][planar]") {
  const PlanarScene stripes = planar_scenes({"stripes1"}, 100).front(),
                    logo = planar_scenes({"logo"}, 100).front();
  for (const PlanarScene* scene : {&stripes, &logo}) {
    double homogeneous = 0;
    for (const char* name : {"homogeneous", "factorized", "aggregate", "aggregate:mc64", "composite",
                             "composite:symmetric", "composite:order1"}) {
      const PlanarMethod method = parse_planar_method(name);
      const double rate =
          evaluations_per_second(PlanarModel(*scene, method.model, baseline_profile(), method.options));
      if (homogeneous == 0) homogeneous = rate;
      std::printf("%-10s %-20s %6.2f M/s, %5.2f x homogeneous\n", scene->name.c_str(), name, 1e-6 * rate,
                  homogeneous / rate);
    }
  }
}

TEST_CASE("median error of 1024 samples by the way of sampling, inside and outside the light",
          "[bench][planar]") {
  for (const char* name : {"constant", "stripes1"}) {
    const PlanarScene scene = planar_scenes({name}, 100).front();
    const PlanarModel model(scene, "composite", baseline_profile());
    const PlanarIntegrator best(model, PlanarSampling::clipped);
    std::map<std::pair<std::string, bool>, std::vector<double>> errors;
    double worst = 0;
    for (const double radius : {0.05, 0.35, 0.65, 0.9, 1.1, 1.5, 2.5, 4.0}) {
      const BssrdfPoint exit = model.point(Vec2(radius * std::cos(0.7), radius * std::sin(0.7)));
      const double truth = truth_at(best, exit);
      std::map<std::string, double> here;
      for (const char* sampling : {"uniform", "profile", "mis", "clipped"}) {
        const PlanarIntegrator integrator(model, planar_sampling_from_name(sampling));
        const auto e = relative_errors(integrator, exit, truth, 1024);
        here[sampling] = median(e);
        auto& all = errors[{sampling, radius < 1}];
        all.insert(all.end(), e.begin(), e.end());
      }
      std::printf("%-10s at %.2f: uniform %.5f profile %.5f mis %.5f clipped %.5f\n", name, radius,
                  here["uniform"], here["profile"], here["mis"], here["clipped"]);
      worst = std::max(worst, here["clipped"] / here["uniform"]);
    }
    const double gain = median(errors[{"uniform", true}]) / median(errors[{"clipped", true}]);
    std::printf("%-10s inside: %.1f x lower than uniform; worst anywhere %.2f x\n", name, gain, worst);
    CHECK(gain > 4);
    CHECK(worst < 1.1);
  }
}

TEST_CASE("time to 2 % noise: the reference and the ways of sampling", "[bench][planar]") {
  const auto to_two_percent = [](double noise, double seconds) {
    return seconds * noise * noise / (0.02 * 0.02);
  };
  for (const char* name : {"stripes1", "logo", "floral", "constant"}) {
    const PlanarScene scene = planar_scenes({name}, 100).front();
    PlanarVolume volume(scene, {});
    volume.run(500000);
    const double reference = to_two_percent(volume.noise(), volume.cpu_seconds());
    std::printf("%-10s reference %.2f M paths/s, %.1f M collisions/s, %.2f CPU s to 2 %%\n", name,
                1e-6 * static_cast<double>(volume.paths()) / volume.cpu_seconds(),
                1e-6 * static_cast<double>(volume.collisions()) / volume.cpu_seconds(), reference);
    for (const char* sampling : {"composite:uniform", "composite:profile", "composite:mis", "composite"}) {
      const TimedImage image = render_planar(scene, parse_planar_method(sampling), baseline_profile(), 64, 1);
      double variance = 0, square = 0;
      for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 10000; ++i) {
          variance += static_cast<double>(image.image.plane(4 + c)[i]);
          square += std::pow(static_cast<double>(image.image.plane(c)[i]), 2);
        }
      const double noise = std::sqrt(variance / square), seconds = to_two_percent(noise, image.cpu_seconds);
      std::printf("%-20s noise %.3f at 64 samples, %.2f CPU s to 2 %%: %.1f x faster than the reference\n",
                  sampling, noise, seconds, reference / seconds);
    }
    const TimedImage shared =
        render_planar_to_noise(scene, parse_planar_method("composite"), baseline_profile(), 0.02, 1);
    std::printf(
        "%-20s %.1f samples a pixel, shared out: %.3f CPU s to 2 %%: %.1f x faster than the reference\n",
        "composite", static_cast<double>(shared.samples) / 10000, shared.cpu_seconds,
        reference / shared.cpu_seconds);
  }
}
