#include "optics/fresnel.h"

#include <catch2/catch.hpp>

using namespace alabaster;

TEST_CASE("Fresnel reflectance at normal incidence is ((eta - 1)/(eta + 1))^2, from either side") {
  for (const double eta : {1.0, 1.1, 1.33, 1.5, 2.4}) {
    const double expected = (eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1));
    CHECK(fresnel_dielectric(1, eta) == Approx(expected).margin(1e-15));
    CHECK(fresnel_dielectric(1, 1 / eta) == Approx(expected).margin(1e-15));
  }
}

TEST_CASE("Fresnel reflectance is the same on both ends of a refracted ray") {
  for (const double eta : {1.01, 1.33, 1.5, 3.0})
    for (double cosine = 0.05; cosine <= 1; cosine += 0.05) {
      const double inside = refracted_cosine(cosine, eta);
      CHECK(fresnel_dielectric(inside, 1 / eta) == Approx(fresnel_dielectric(cosine, eta)).epsilon(1e-12));
      CHECK(refracted_cosine(inside, 1 / eta) == Approx(cosine).epsilon(1e-12));
    }
}

TEST_CASE("Fresnel reflectance: grazing, Brewster's angle, total reflection") {
  CHECK(fresnel_dielectric(0, 1.5) == 1);
  CHECK(fresnel_dielectric(0.7, 1 / 1.5) == 1);  // the critical cosine is 0.745
  // At tan = eta only the perpendicular half is reflected: ((1 - eta^2)/(1 + eta^2))^2 / 2.
  CHECK(fresnel_dielectric(1 / std::sqrt(1 + 2.25), 1.5) == Approx(0.5 * (1.25 * 1.25) / (3.25 * 3.25)));
  for (const double cosine : {1e-6, 0.3, 1.0}) CHECK(fresnel_dielectric(cosine, 1) == 0);
}

TEST_CASE("diffuse transmittance matches its integral and the published 0.0918 reflected at eta = 1.5") {
  CHECK(1 - diffuse_transmittance(1.5) == Approx(0.0918).margin(5e-5));
  CHECK(diffuse_transmittance(1) == Approx(1).margin(1e-12));
  for (const double eta : {1.0001, 1.01, 1.049, 1.051, 1.3, 2.0, 1 / 1.5}) {
    const int steps = 200000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const double cosine = (i + 0.5) / steps;
      sum += (1 - fresnel_dielectric(cosine, eta)) * 2 * cosine;
    }
    CHECK(diffuse_transmittance(eta) == Approx(sum / steps).margin(3e-6));
  }
}
