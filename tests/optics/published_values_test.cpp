// Others' published or exact totals. Every estimate must lie within the value's own tolerance plus three of
// its standard errors; photons are many enough for that to mean something, seeds are fixed.

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "core/vec.h"
#include "optics/albedo_walk.h"

using namespace alabaster;

namespace {

constexpr double infinite = HUGE_VAL;

struct PublishedTotal {
  const char* source;
  double eta, g, albedo, thickness;
  EntryKind entry;
  bool transmitted;
  double value, tolerance;
};

const std::vector<PublishedTotal> totals{
    // van de Hulst 1980, quoted in the MCML manual (Wang & Jacques 1995), table 6.1.
    {"van de Hulst slab R", 1, 0.75, 0.9, 2, EntryKind::normal, false, 0.09739, 0.0002},
    {"van de Hulst slab T", 1, 0.75, 0.9, 2, EntryKind::normal, true, 0.66096, 0.0004},
    // Giovanelli 1955, quoted there in table 6.2; the specular reflection of 0.04 is included.
    {"Giovanelli half-space", 1.5, 0, 0.9, infinite, EntryKind::normal, false, 0.2600, 0.0003},
    // Chandrasekhar 1950: R(1) = 1 - sqrt(1 - alpha) H(1), isotropic scattering without a boundary.
    {"Chandrasekhar 0.5", 1, 0, 0.5, infinite, EntryKind::normal, false, 0.115226, 0.000002},
    {"Chandrasekhar 0.9", 1, 0, 0.9, infinite, EntryKind::normal, false, 0.414947, 0.000002},
    {"Chandrasekhar 0.99", 1, 0, 0.99, infinite, EntryKind::normal, false, 0.752721, 0.000002},
    // The same, diffuse light: 1 - 2 sqrt(1 - alpha) times the integral of mu H(mu).
    {"Chandrasekhar diffuse 0.5", 1, 0, 0.5, infinite, EntryKind::diffuse, false, 0.146544, 0.000002},
    {"Chandrasekhar diffuse 0.9", 1, 0, 0.9, infinite, EntryKind::diffuse, false, 0.478024, 0.000002},
    // Adding-doubling with 32 quadrature points; the specular reflection is included.
    {"adding-doubling 0.5", 1.5, 0.3, 0.5, infinite, EntryKind::normal, false, 0.06542, 0.0002},
    {"adding-doubling 0.9", 1.5, 0.3, 0.9, infinite, EntryKind::normal, false, 0.21022, 0.0003},
    {"adding-doubling 0.99", 1.5, 0.3, 0.99, infinite, EntryKind::normal, false, 0.55072, 0.0006},
};

AlbedoWalkOptions walk_of(const PublishedTotal& row, uint64_t photons) {
  AlbedoWalkOptions options;
  options.medium = {row.g, row.eta};
  options.albedo = row.albedo;
  options.entry = row.entry;
  if (std::isfinite(row.thickness)) options.thickness = row.thickness;
  options.photons = photons;
  options.seed = 7;
  return options;
}

// H(mu) of isotropic scattering by iterating 1/H = sqrt(1 - alpha) + (alpha/2) integral mu' H(mu') / (mu +
// mu').
double chandrasekhar_h(double mu, double albedo) {
  const int points = 400;
  std::vector<double> nodes, h(points, 1.0);
  for (int i = 0; i < points; ++i) nodes.push_back((i + 0.5) / points);
  const auto invert = [&](double at) {
    double sum = std::sqrt(1 - albedo);
    for (std::size_t i = 0; i < points; ++i) sum += 0.5 * albedo * nodes[i] * h[i] / (at + nodes[i]) / points;
    return 1 / sum;
  };
  for (int round = 0; round < 200; ++round) {
    std::vector<double> next;
    for (const double node : nodes) next.push_back(invert(node));
    h = next;
  }
  return invert(mu);
}

}  // namespace

TEST_CASE("totals of half-spaces and slabs agree with published values") {
  for (const PublishedTotal& row : totals) {
    const AlbedoWalkResult result = walk_at_albedo(walk_of(row, 400000));
    const Estimate measured = row.transmitted ? result.transmittance() : result.total_reflectance();
    INFO(row.source << ": " << measured.value << " +- " << measured.standard_error << ", published "
                    << row.value);
    CHECK(std::abs(measured.value - row.value) <= row.tolerance + 3 * measured.standard_error);
    CHECK(measured.standard_error < 0.6 / std::sqrt(400000.0));
  }
}

TEST_CASE("totals of half-spaces and slabs agree with published values, 50 million photons", "[slow]") {
  for (const PublishedTotal& row : totals) {
    const AlbedoWalkResult result = walk_at_albedo(walk_of(row, 50000000));
    const Estimate measured = row.transmitted ? result.transmittance() : result.total_reflectance();
    WARN(row.source << ": " << measured.value << " +- " << measured.standard_error << ", published "
                    << row.value);
    CHECK(std::abs(measured.value - row.value) <= row.tolerance + 3 * measured.standard_error);
  }
}

TEST_CASE("oblique light agrees with Chandrasekhar's H function") {
  // Half-space, isotropic, no boundary: the reflectance for incidence at mu is 1 - sqrt(1 - alpha) H(mu).
  for (const double cosine : {0.2, 0.6}) {
    AlbedoWalkOptions options;
    options.medium = {0, 1};
    options.albedo = 0.8;
    options.entry = EntryKind::direction;
    options.entry_cosine = cosine;
    options.photons = 400000;
    const Estimate measured = walk_at_albedo(options).total_reflectance();
    const double expected = 1 - std::sqrt(0.2) * chandrasekhar_h(cosine, 0.8);
    CHECK(std::abs(measured.value - expected) <= 1e-4 + 3 * measured.standard_error);
  }
}

TEST_CASE("the single-scattering profile is the exact one") {
  // Index-matched, isotropic, normal incidence: light scattered once at depth z towards rho leaves with
  // exp(-z) exp(-r) z / (4 pi r^3) per unit area, r^2 = z^2 + rho^2; integrated over z. Its total is (1 - ln
  // 2)/2.
  const auto exact = [](double rho) {
    const int steps = 20000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const double z = 30 * std::pow((i + 0.5) / steps, 3), dz = 90 * std::pow((i + 0.5) / steps, 2) / steps;
      const double r = std::hypot(z, rho);
      sum += std::exp(-z - r) * z / (4 * pi * r * r * r) * dz;
    }
    return sum;
  };
  // Published values of R_1 / alpha.
  CHECK(exact(0.1) == Approx(0.47491).epsilon(2e-5));
  CHECK(exact(0.5) == Approx(0.030247).epsilon(2e-5));
  CHECK(exact(1) == Approx(0.0052348).epsilon(2e-5));
  CHECK(exact(2) == Approx(4.5667e-4).epsilon(2e-5));
  CHECK(exact(5) == Approx(2.545e-6).epsilon(2e-4));

  // The walk, stopped before its second scattering.
  const uint64_t photons = 2000000;
  std::vector<uint64_t> counts(RadialBins::count);
  uint64_t total = 0;
  Rng rng(21);
  for (uint64_t i = 0; i < photons; ++i) {
    Photon photon;
    if (walk(HalfSpace{}, WalkMedium{0, 1}, photon, rng, [](const Photon& p, Rng&) { return p.order < 2; }) ==
        WalkEnd::left) {
      ++total;
      ++counts[static_cast<std::size_t>(RadialBins::index_of_square(photon.position.x * photon.position.x +
                                                                    photon.position.y * photon.position.y))];
    }
  }
  const double expected_total = (1 - std::log(2.0)) / 2, n = static_cast<double>(photons);
  CHECK(std::abs(static_cast<double>(total) / n - expected_total) <
        4 * std::sqrt(expected_total * (1 - expected_total) / n));
  int tested = 0;
  for (int bin = 1; bin <= RadialBins::inner; ++bin) {
    const double from = RadialBins::edge(bin), to = RadialBins::edge(bin + 1), middle = 0.5 * (from + to);
    const double expected =
        n * (to - from) / 6 * 2 * pi * (from * exact(from) + 4 * middle * exact(middle) + to * exact(to));
    if (expected < 30) continue;
    ++tested;
    INFO("rho " << middle << ": " << counts[static_cast<std::size_t>(bin)] << ", exact " << expected);
    CHECK(std::abs(static_cast<double>(counts[static_cast<std::size_t>(bin)]) - expected) <
          4.5 * std::sqrt(expected));
  }
  CHECK(tested > 80);
}
