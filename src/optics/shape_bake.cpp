#include "optics/shape_bake.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "optics/aim_bake.h"

namespace alabaster {

namespace {

constexpr double log2_e = 1.4426950408889634;

// Distance from the entry in the tabulated coordinate (chord or lateral distance) at a node position.
double node_distance(ShapeFamily family, double size, double node) {
  const double unit = ShapeGrid::is_slab(family) ? size : 2 * size;
  return unit * std::exp2(ShapeGrid::first_octave(family) + node / ShapeGrid::nodes_per_octave);
}
double node_position(ShapeFamily family, double size, double distance) {
  const double unit = ShapeGrid::is_slab(family) ? size : 2 * size;
  const double position =
      (std::log2(distance / unit) - ShapeGrid::first_octave(family)) * ShapeGrid::nodes_per_octave;
  return std::clamp(position, 0.0, ShapeGrid::nodes(family) - 1.0);
}

// Of the half-space, between two distances: 2 pi rho R(chord) integrated by Simpson's rule.
double half_space_energy(ShapeFamily family, double size, double albedo, double from, double to,
                         const ProfileTable& half_space) {
  const auto density = [&](double rho) {
    const double chord = family == ShapeFamily::slab_far ? std::hypot(rho, size) : rho;
    return 2 * pi * rho * half_space.evaluate_over_albedo(albedo, chord);
  };
  return (to - from) / 6 * (density(from) + 4 * density(0.5 * (from + to)) + density(to));
}

// Bins beyond this distance miss paths longer than the orders tallied, unless absorption ends them first (as
// in bake.cpp).
double trusted_radius(double albedo, double g) {
  const double orders_missing = (1 - albedo) * static_cast<double>(OrderGroups::limit);
  return 0.33 * std::sqrt(static_cast<double>(OrderGroups::limit) / (1 - g)) *
         (1 + 0.25 * orders_missing * orders_missing);
}

struct Bins {
  std::vector<double> position, log_ratio, weight;  // node position, ln of the factor, photons it is worth
  std::vector<double> expected;                     // the half-space's energy
  double measured = 0, variance = 0;                // of all these bins together
};

Bins gather(ShapeFamily family, double size, double albedo, const std::vector<Estimate>& energy,
            const ProfileTable& half_space) {
  Bins bins;
  const double end = ShapeGrid::is_slab(family) ? HUGE_VAL : 2 * size;
  for (int b = 1; b <= RadialBins::inner; ++b) {
    Estimate e = energy[static_cast<std::size_t>(b)];
    const double from = RadialBins::edge(b), to = RadialBins::edge(b + 1);
    if (from > 0.999 * end) break;
    // A chord of a whole diameter may round up into the next bin.
    if (to > 0.999 * end && b < RadialBins::inner) e.value += energy[static_cast<std::size_t>(b) + 1].value;
    const double expected = half_space_energy(family, size, albedo, from, to, half_space);
    const bool measured = e.value > 1e-250 && e.standard_error > 0 && expected > 1e-300;
    const double photons = measured ? std::pow(e.value / e.standard_error, 2) : 0;
    // Few photons make a biased logarithm, and far beyond the diffusion length a badly biased one: what is
    // seen there are paths of typical length, what counts are short ones that are not seen.
    const double certainty = std::clamp((photons - 16) / 48, 0.0, 1.0);
    const double fade = certainty * certainty * (3 - 2 * certainty);
    const double trust = 1 / (1 + std::pow(from / trusted_radius(albedo, half_space.g()), 8));
    bins.position.push_back(node_position(family, size, std::sqrt(from * to)));
    bins.log_ratio.push_back(measured ? std::log(e.value / expected) : 0);
    bins.weight.push_back(photons * fade * trust);
    bins.expected.push_back(expected);
    bins.measured += e.value;
    bins.variance += e.standard_error * e.standard_error;
  }
  return bins;
}

double interpolated(const Eigen::VectorXd& nodes, double position) {
  const auto i = std::min(static_cast<Eigen::Index>(position), nodes.size() - 2);
  const double t = position - static_cast<double>(i);
  return (1 - t) * nodes[i] + t * nodes[i + 1];
}

// A table piecewise linear over log distance whose difference to that of the albedo before is smooth and
// small; where nothing is measured it is that one's. At short distances, where every surface is flat, it
// tends to 0.
Eigen::VectorXd smooth(ShapeFamily family, double size, const Bins& bins, const Eigen::VectorXd& before) {
  const Eigen::Index n = ShapeGrid::nodes(family);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (std::size_t k = 0; k < bins.position.size(); ++k) {
    const auto i = std::min(static_cast<Eigen::Index>(bins.position[k]), n - 2);
    const double t = bins.position[k] - static_cast<double>(i), w = bins.weight[k];
    const double change = bins.log_ratio[k] - interpolated(before, bins.position[k]);
    matrix(i, i) += w * (1 - t) * (1 - t);
    matrix(i, i + 1) += w * t * (1 - t);
    matrix(i + 1, i) += w * t * (1 - t);
    matrix(i + 1, i + 1) += w * t * t;
    right[i] += w * (1 - t) * change;
    right[i + 1] += w * t * change;
  }
  const double bend = 400, slope = 1, level = 0.02;  // 1 / typical squares
  for (Eigen::Index i = 0; i < n; ++i) {
    matrix(i, i) += level;
    if (family != ShapeFamily::slab_far) {
      const double flat = 25 * std::pow(0.02 / node_distance(family, size, static_cast<double>(i)), 2);
      matrix(i, i) += flat;
      right[i] -= flat * before[i];
    }
    if (i + 1 < n) {
      matrix(i, i) += slope, matrix(i + 1, i + 1) += slope;
      matrix(i, i + 1) -= slope, matrix(i + 1, i) -= slope;
    }
    if (i + 2 < n) {
      const double stencil[3] = {1, -2, 1};
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) matrix(i + a, i + b) += bend * stencil[a] * stencil[b];
    }
  }
  return before + matrix.ldlt().solve(right);
}

// What all bins hold together is better known than any of them: the factors are scaled to it. In full where
// it is known to 1 %, less where it is as uncertain as the factors are (about a tenth), not at all beyond 20
// %.
double scale_to_total(const Bins& bins, const Eigen::VectorXd& nodes) {
  double sum = 0;
  for (std::size_t k = 0; k < bins.position.size(); ++k)
    sum += bins.expected[k] * std::exp(interpolated(nodes, bins.position[k]));
  const double square = bins.measured * bins.measured;
  if (!(bins.measured > 0) || !(sum > 0) || bins.variance > 0.04 * square) return 0;
  const double doubt = std::max(0.0, bins.variance / square - 1e-4);
  return std::clamp(std::log(bins.measured / sum) / (1 + doubt / 1e-2), -0.3, 0.3);
}

}  // namespace

std::vector<double> shape_factors(ShapeFamily family, double size, double albedo,
                                  const std::vector<Estimate>& energy, const ProfileTable& half_space,
                                  const std::vector<double>& before) {
  const Bins bins = gather(family, size, albedo, energy, half_space);
  Eigen::VectorXd start = Eigen::VectorXd::Zero(ShapeGrid::nodes(family));
  for (std::size_t i = 0; i < before.size(); ++i) start[static_cast<Eigen::Index>(i)] = before[i] / log2_e;
  const Eigen::VectorXd nodes = smooth(family, size, bins, start);
  const double shift = scale_to_total(bins, nodes);
  std::vector<double> result;
  for (Eigen::Index i = 0; i < nodes.size(); ++i) result.push_back(log2_e * (nodes[i] + shift));
  return result;
}

WalkBody shape_body(ShapeFamily family, double size) {
  if (family == ShapeFamily::ball) return WalkBody::ball(size);
  if (family == ShapeFamily::cavity) return WalkBody::cavity(size);
  return WalkBody::slab(size);
}

BodyWalkOptions shape_walk_options(ShapeFamily family, double size, const ShapeBakeOptions& options) {
  BodyWalkOptions walk{options.medium, options.photons, options.seed, {}};
  const bool is_cavity = family == ShapeFamily::cavity;
  // At low albedo and g near 1 little comes back, and all of it early; small balls and slabs return plenty.
  if (is_cavity || size >= 4) {
    walk.stages.first_thinning = 3;
    walk.photons <<= 3;
  }
  if (!is_cavity) return walk;
  // After n orders a photon is about sqrt(n / (1 - g)) away and meets the cavity again with a chance of its
  // radius over that: until it is a radius away it leaves as from a half-space, then ever more seldom.
  const double square = size * size;
  const auto first_beyond = [](double orders) {
    int stage = 1;
    while (stage < WalkStages::count && static_cast<double>(WalkStages::limit(stage)) < orders) ++stage;
    return stage;
  };
  walk.stages.quartered_from = first_beyond(square * (1 - options.medium.g));
  walk.stages.last =
      std::clamp(first_beyond(1e4 * square / (1 - options.medium.g)), 3, WalkStages::count - 1);
  return walk;
}

ShapeTable bake_shapes(const ShapeBakeOptions& options, const ProfileTable& half_space,
                       const std::function<void(double)>& progress) {
  ShapeTable table;
  table.g = options.medium.g;
  table.eta = options.medium.eta;
  table.seed = options.seed;
  for (int f = 0; f < ShapeGrid::family_count; ++f)
    table.log2_factor[static_cast<std::size_t>(f)].resize(
        ShapeTable::index(static_cast<ShapeFamily>(f), ShapeGrid::sizes, 0, 0));
  const auto tabulate = [&](ShapeFamily family, int size_index, const PathTally& tally) {
    const double size = ShapeGrid::size(size_index);
    std::vector<double> factors;
    for (int row = 0; row < ShapeGrid::rows; ++row) {
      const double albedo = ShapeGrid::albedo(row);
      const std::vector<Estimate> energy = family == ShapeFamily::slab_far
                                               ? far_radial_energy_over_albedo(tally, albedo)
                                               : radial_energy_over_albedo(tally, albedo);
      factors = shape_factors(family, size, albedo, energy, half_space, factors);
      for (int node = 0; node < ShapeGrid::nodes(family); ++node) {
        const double units = factors[static_cast<std::size_t>(node)] / ShapeTable::step;
        table
            .log2_factor[static_cast<std::size_t>(family)][ShapeTable::index(family, size_index, node, row)] =
            static_cast<int16_t>(std::lround(std::clamp(units, -32767.0, 32767.0)));
      }
    }
  };
  for (const double slope : bake_aim(options.medium, options.photons, options.seed))
    table.aim.push_back(static_cast<int16_t>(std::lround(slope / ShapeTable::step)));
  int done = 0;
  for (const ShapeFamily family : {ShapeFamily::ball, ShapeFamily::cavity, ShapeFamily::slab_near})
    for (int i = 0; i < ShapeGrid::sizes; ++i) {
      const double size = ShapeGrid::size(i);
      const PathTally tally = body_tally(shape_body(family, size), shape_walk_options(family, size, options));
      table.photons += tally.photons();
      table.collisions += tally.collisions();
      tabulate(family, i, tally);
      if (family == ShapeFamily::slab_near) tabulate(ShapeFamily::slab_far, i, tally);
      if (progress) progress(++done / (3.0 * ShapeGrid::sizes));
    }
  table.provenance =
      fmt::format("balls, cavities, slabs, uniform radiance in; {} photons, {:.3g} collisions, seed {}",
                  table.photons, static_cast<double>(table.collisions), table.seed);
  return table;
}

}  // namespace alabaster
