#include "bssrdf/last_collision.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace alabaster {

namespace {

/// A part of exp(-s), s in mean free paths.
struct Piece {
  double share, mean, deviation;
};
// Below and above 1.5.
constexpr std::array<Piece, 2> flights{{{0.77687, 0.56917, 0.41008}, {0.22313, 2.5, 1}}};
// A Gaussian as wide across the ray as along it: of the two, this serves stripes and dots best.
constexpr double roundness = 0.5;
// Of the sine outside, over the directions in which light leaves, T(cos) cos: at eta = 1.5, and nearly so at
// others.
constexpr double mean_square_sine = 0.478;
// Less than this, in mean free paths, is straight down.
constexpr double least_offset = 1e-3;

/// What the mean flight is shortened by where it must end before `limit` (mean free paths).
double shortened(double limit) {
  if (limit > 30) return 1;
  const double beyond = std::exp(-limit);
  return 1 - limit * beyond / (1 - beyond);
}

/// `path`: the mean free path, m.
Rgb last_collision(const BssrdfMedium& medium, const KernelPlacement& placement, const BssrdfPoint& exit,
                   double path) {
  const Vec3 &n = exit.surface.shading_normal, &v = exit.towards_viewer;
  const double eta = medium.profile->eta();
  const bool averaged = v == Vec3(0);
  const Vec3 sideways = averaged ? Vec3(0) : (glm::dot(v, n) * n - v) / eta;
  const double square_sine = averaged ? mean_square_sine / (eta * eta) : length_squared(sideways);
  if (square_sine < least_offset * least_offset) return exit.albedo;
  const double cosine = std::sqrt(std::max(1 - square_sine, 0.0));
  const double inverse_thickness = path * exit.shape.inverse_thickness;
  if (inverse_thickness > 0) path *= shortened(0.5 / (inverse_thickness * cosine));
  std::array<KernelFootprint, flights.size()> footprints;
  std::array<double, flights.size()> shares;
  for (std::size_t k = 0; k < flights.size(); ++k) {
    const Piece& flight = flights[k];
    // Over all directions: half the mean square along either axis.
    const double spread =
        averaged ? std::sqrt(0.5 * (flight.mean * flight.mean + flight.deviation * flight.deviation))
                 : roundness * flight.deviation;
    shares[k] = flight.share;
    footprints[k] =
        placement.around(exit.surface, spread * std::sqrt(square_sine) * path, flight.mean * path * sideways);
  }
  return medium.albedo->mixture(footprints, shares);
}

}  // namespace

Rgb last_collision_albedo(const BssrdfMedium& medium, const KernelPlacement& placement,
                          const BssrdfPoint& exit) {
  const Rgb& sigma_t = medium.sigma_t;
  Rgb albedo = last_collision(medium, placement, exit, 1 / sigma_t.r);
  if (sigma_t.is_grey()) return albedo;
  albedo.g = last_collision(medium, placement, exit, 1 / sigma_t.g).g;
  albedo.b = last_collision(medium, placement, exit, 1 / sigma_t.b).b;
  return albedo;
}

}  // namespace alabaster
