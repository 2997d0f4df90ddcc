#include "integrators/depth_guide.h"

#include <catch2/catch.hpp>

#include "integrators/walk_body.h"
#include "optics/phase_function.h"

using namespace alabaster;
using namespace alabaster::test;

TEST_CASE("the importance decays as the transport equation says") {
  // Isotropic scattering: albedo atanh(kappa) = kappa (Case & Zweifel 1967).
  for (const double albedo : {0.8, 0.9, 0.99, 0.9999}) {
    const double kappa = DepthGuide::kappa_of(0, albedo);
    INFO("albedo " << albedo << ", kappa " << kappa);
    CHECK(albedo * std::atanh(kappa) == Approx(kappa).epsilon(1e-6));
  }
  CHECK(DepthGuide::kappa_of(0.3, 1) < 1e-6);
  CHECK(DepthGuide::kappa_of(0.3, 0) == Approx(DepthGuide::largest_kappa));
  // Diffusion, where little is absorbed.
  CHECK(DepthGuide::kappa_of(0.9, 0.9999) == Approx(std::sqrt(3 * 0.0001 * (1 - 0.9))).epsilon(0.02));
  for (const double g : {-0.9, 0.0, 0.3, 0.9})
    for (double albedo = 0.1; albedo < 1; albedo += 0.1)
      CHECK(DepthGuide::kappa_of(g, albedo) >= DepthGuide::kappa_of(g, albedo + 0.1));
}

TEST_CASE("phi is positive, and its mean over a lobe is what is said (z-test at 1e-4, Sidak over 60)") {
  Rng rng(31);
  for (const double g : {-0.6, 0.0, 0.3, 0.8, 0.95})
    for (const double kappa : {0.0, 0.2, 0.5, 0.8}) {
      const DepthGuide guide(g, kappa);
      for (double mu = -1; mu <= 1; mu += 0.01) CHECK(guide.phi(mu) > 0.05);
      for (const double mu : {-0.95, 0.1, 0.8}) {
        const Vec3 direction(std::sqrt(1 - mu * mu), 0, mu);
        RunningMoments mean;
        for (int i = 0; i < 5000; ++i) mean.add(guide.phi(scatter(direction, g, rng).z));
        INFO("g " << g << ", kappa " << kappa << ", mu " << mu << ": " << mean.mean() << ", said "
                  << guide.mean_phi(mu));
        const double excess = std::max(0.0, std::abs(mean.mean() - guide.mean_phi(mu)) - 1e-9);
        CHECK(two_sided_normal_p_value(excess / (mean.standard_error() + 1e-12)) > sidak(1e-4, 60));
      }
    }
}

TEST_CASE("steered directions have the density that is said (z-test of moments at 1e-4, Sidak over 24)") {
  // Moments of the drawn cosine, and of the turn, against phase function x phi / mean phi by weighting plain
  // directions.
  Rng rng(32);
  for (const double g : {0.0, 0.3, 0.8})
    for (const double kappa : {0.3, 0.7}) {
      const DepthGuide guide(g, kappa);
      for (const double mu : {-0.9, 0.4}) {
        const Vec3 normal = glm::normalize(Vec3(0.2, -0.5, 0.7));
        const Frame frame(normal);
        const Vec3 direction = frame.to_world({0, std::sqrt(1 - mu * mu), mu});
        RunningMoments drawn[2], expected[2];
        for (int i = 0; i < 20000; ++i) {
          const Vec3 a = guide.scatter(direction, normal, rng), b = scatter(direction, g, rng);
          const double weight = guide.phi(glm::dot(b, normal)) / guide.mean_phi(mu);
          drawn[0].add(glm::dot(a, normal)), expected[0].add(weight * glm::dot(b, normal));
          drawn[1].add(glm::dot(a, direction)), expected[1].add(weight * glm::dot(b, direction));
        }
        for (int k = 0; k < 2; ++k)
          CHECK(two_sided_normal_p_value(z_of(drawn[k], expected[k])) > sidak(1e-4, 24));
      }
    }
}

TEST_CASE("steered walks see what plain walks see, with less noise (z-test at 1e-4, Sidak over 24)") {
  struct Case {
    TriangleMesh mesh;
    Medium medium;
  };
  for (Case& c : std::vector<Case>{{make_blob(0.06, 0.2, 48), {Rgb(0.004), 0.3, 1.5}},
                                   {make_torus(0.05, 0.02, 48), {Rgb(0.004, 0.008, 0.02), 0.3, 1.5}},
                                   {make_slab(0.1, 0.02, 6), {Rgb(0.01), 0.8, 1.5}},
                                   {make_blob(0.06, 0.2, 48), {Rgb(0.02), -0.3, 1}}}) {
    const Body body(std::move(c.mesh));
    const StripedAlbedo field(body.mesh, 0.02);
    for (const ClosestPointMode mode : {ClosestPointMode::cached, ClosestPointMode::exact}) {
      VolumeWalkOptions steered, plain;
      steered.closest_point = plain.closest_point = mode;
      plain.steered = false;
      const Returned a = returned(body, walk_in(body, c.medium, field, steered), 15000, 33);
      const Returned b = returned(body, walk_in(body, c.medium, field, plain), 15000, 34);
      for (int k = 0; k < 3; ++k) {
        const RunningMoments &m = a.scattered[k], &n = b.scattered[k];
        INFO("channel " << k << ": " << m.mean() << " +- " << m.standard_error() << " against " << n.mean()
                        << " +- " << n.standard_error());
        CHECK(two_sided_normal_p_value(z_of(m, n)) > sidak(1e-4, 24));
      }
    }
  }
}
