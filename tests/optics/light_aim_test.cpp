#include "optics/light_aim.h"

#include <catch2/catch.hpp>

#include "core/statistics.h"
#include "optics/photon_walk.h"

using namespace alabaster;

namespace {

Vec3 outside(const Vec3& normal, double cosine, double azimuth) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return Frame(normal).to_world(Vec3(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine));
}

const Vec3 entry(0.3, -0.8, 0.4), exit_point(1.1, 0.2, 0.1);
const Vec3 entry_normal = glm::normalize(Vec3(-0.2, -0.5, 1)),
           exit_normal = glm::normalize(Vec3(0.6, 0.1, 1));
const Rgb concentration(0.2, 0.7, AimSlopes::largest);

}  // namespace

TEST_CASE("light's aim is reciprocal, positive and 1 without concentration", "[optics]") {
  Rng rng(3);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 w = outside(entry_normal, rng.uniform(), 2 * pi * rng.uniform());
    const Vec3 v = outside(exit_normal, rng.uniform(), 2 * pi * rng.uniform());
    const Rgb there = LightAim(concentration, entry, entry_normal, exit_point, exit_normal, v).at(w);
    const Rgb back = LightAim(concentration, exit_point, exit_normal, entry, entry_normal, w).at(v);
    for (int c = 0; c < 3; ++c) {
      CHECK(there[c] == Approx(back[c]).epsilon(1e-5));
      CHECK(there[c] > 0);
    }
    CHECK(LightAim(Rgb(0), entry, entry_normal, exit_point, exit_normal, v).at(w) == Rgb(1));
    const Rgb nearly = LightAim(Rgb(1e-4), entry, entry_normal, exit_point, exit_normal, v).at(w);
    CHECK(nearly.r == Approx(1).margin(3e-4));
  }
  CHECK(LightAim().at(Vec3(0, 0, 1)) == Rgb(1));
  CHECK(LightAim().mean() == Rgb(1));
}

TEST_CASE("the mean of light's aim over directions is 1, at any pair of elevations", "[optics]") {
  // Turning both directions about their normals stands for the azimuth of the chord.
  constexpr int turns = 64;
  for (const double cos_w : {0.1, 0.6, 0.95})
    for (const double cos_v : {0.2, 0.8})
      for (const double apart : {0.0, 1.0, 2.5}) {
        Rgb sum;
        for (int k = 0; k < turns; ++k) {
          const double azimuth = 2 * pi * k / turns;
          // The frames of both ends, each with the chord's part within the surface as its axis.
          const Vec3 u = glm::normalize(entry - exit_point);
          const auto turned = [&](const Vec3& n, double cosine, double angle) {
            const Vec3 along = glm::normalize(u - glm::dot(u, n) * n), across = glm::cross(n, along);
            const double sine = std::sqrt(1 - cosine * cosine);
            return sine * (std::cos(angle) * along + std::sin(angle) * across) + cosine * n;
          };
          const Vec3 w = turned(entry_normal, cos_w, azimuth),
                     v = turned(exit_normal, cos_v, azimuth + apart);
          sum +=
              (1.0 / turns) * LightAim(concentration, entry, entry_normal, exit_point, exit_normal, v).at(w);
        }
        for (int c = 0; c < 3; ++c) CHECK(sum[c] == Approx(1).epsilon(2e-6));
      }
}

TEST_CASE("the mean over a uniform hemisphere, against sampling of it", "[optics]") {
  Rng rng(8);
  for (const double azimuth : {0.2, 1.5, 2.9}) {
    const LightAim aim(concentration, entry, entry_normal, exit_point, exit_normal,
                       outside(exit_normal, 0.5, azimuth));
    std::array<RunningMoments, 3> drawn;
    for (int k = 0; k < 100000; ++k) {
      const double cosine = std::sqrt(rng.uniform_positive());
      if (rng.uniform() < fresnel_dielectric(cosine, 1.5)) continue;
      const Rgb factor = aim.at(outside(entry_normal, cosine, 2 * pi * rng.uniform()));
      for (int c = 0; c < 3; ++c) drawn[static_cast<std::size_t>(c)].add(factor[c]);
    }
    const Rgb mean = aim.mean();
    for (int c = 0; c < 3; ++c) {
      const RunningMoments& d = drawn[static_cast<std::size_t>(c)];
      CHECK(std::abs(mean[c] - d.mean()) < 0.01 * d.mean() + 3.5 * d.standard_error());
    }
  }
}

TEST_CASE("concentrations of light's aim give the slopes they stand for", "[optics]") {
  const AimSlopes slopes(1.5);
  CHECK(slopes.slope(0) == 0);
  CHECK(slopes.slope(0.1) == Approx(0.1).epsilon(0.01));
  double before = -1;
  for (int k = 0; k <= 95; ++k) {
    const double now = slopes.concentration(0.01 * k);
    CHECK(now > before);
    CHECK(slopes.slope(now) == Approx(0.01 * k).margin(1e-12));
    before = now;
  }
  CHECK(slopes.concentration(5) == AimSlopes::largest);
  Rng rng(4);
  const Vec3 n(0, 0, 1);
  for (const double k : {0.4, 0.8, AimSlopes::largest}) {
    RunningMoments along, square;
    for (int i = 0; i < 200000; ++i) {
      const auto direction = [&] {
        for (;;) {
          const double cosine = std::sqrt(rng.uniform_positive());
          if (rng.uniform() >= fresnel_dielectric(cosine, 1.5))
            return outside(n, cosine, 2 * pi * rng.uniform());
        }
      };
      const Vec3 w = direction(), v = direction();
      along.add(w.x * LightAim(Rgb(k), Vec3(1, 0, 0), n, Vec3(0), n, v).at(w).r);
      square.add(w.x * w.x);
    }
    CHECK(std::abs(along.mean() - slopes.slope(k) * square.mean()) < 3.5 * along.standard_error() + 0.002);
  }
}
