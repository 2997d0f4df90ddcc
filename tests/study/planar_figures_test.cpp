#include "study/planar_figures.h"

#include <catch2/catch.hpp>

#include "study/planar_scene_file.h"

using namespace alabaster;

TEST_CASE("eq. 2 is exact where all albedos agree, and exceeds all bounds as the albedo between falls") {
  const ProfileTable& profile = baseline_profile();
  for (const bool apart : {false, true})
    for (const double albedo : {0.2, 0.9}) CHECK(energy_ratio(profile, albedo, albedo, apart) == Approx(1));
  CHECK(energy_ratio(profile, 0.9, 0.02, false) > energy_ratio(profile, 0.9, 0.04, false));
  // 1 / alpha_t: order 1 alone.
  CHECK(energy_ratio(profile, 0.9, 0.01, false) ==
        Approx(2 * energy_ratio(profile, 0.9, 0.02, false)).epsilon(0.05));
  CHECK(energy_ratio(profile, 0.3, 0.01, false) > 1);
  CHECK(energy_ratio(profile, 0.3, 0.01, true) < 1);
}

TEST_CASE("one albedo never exceeds the basis, two tones of stripes do by eq. 2") {
  const ProfileTable& profile = baseline_profile();
  const auto excess = [&](const char* scene, const char* model) {
    return energy_excess(PlanarModel(planar_scenes({scene}, 20).front(), model, profile), profile, 1);
  };
  CHECK(excess("constant", "composite").share == 0);
  CHECK(excess("stripes1", "homogeneous").share == 0);
  CHECK(excess("stripes1", "composite").worst < 10);
}

TEST_CASE("speed is measured for every model and way of sampling") {
  const PlanarSpeed speed =
      measure_planar_speed(planar_scenes({"constant"}, 40).front(), baseline_profile(), 1);
  CHECK(speed.evaluations.size() == 7);
  for (const auto& [name, rate] : speed.evaluations) CHECK(rate > 0);
  CHECK(speed.seconds_to_2.size() == 4);
  CHECK(speed.reference_seconds_to_2 > 0);
  CHECK(speed.lattice_seconds_to_2 > 0);
}
