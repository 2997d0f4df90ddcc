#include "study/footprint.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "optics/photon_walk.h"

namespace alabaster {

double FootprintFit::log_density(double along, double across) const {
  std::array<double, 3> logs;
  for (std::size_t k = 0; k < 3; ++k) {
    const double s2 = position[k] * position[k];
    const double d2 = (along - position[k]) * (along - position[k]) + across * across;
    logs[k] = std::log(weight[k] / (2 * pi * s2)) - 0.5 * d2 / s2;
  }
  // The largest is taken out: far away all three underflow.
  const double largest = *std::max_element(logs.begin(), logs.end());
  double sum = 0;
  for (const double l : logs) sum += std::exp(l - largest);
  return largest + std::log(sum);
}

namespace {

// One step of expectation-maximisation; returns the largest change of a position.
double improve(FootprintFit& fit, const std::vector<FootprintVertex>& vertices) {
  // Sums of responsibilities, and of them times u and times u^2 + v^2.
  std::array<double, 3> n{}, u{}, square{};
  for (const FootprintVertex& p : vertices) {
    const double s = p.along * p.along + p.across * p.across;
    std::array<double, 3> r;
    for (std::size_t k = 0; k < 3; ++k) {
      const double t = fit.position[k];
      r[k] = fit.weight[k] / (t * t) * std::exp(-0.5 * ((s - 2 * p.along * t) / (t * t) + 1));
    }
    const double total = r[0] + r[1] + r[2];
    if (!(total > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = p.weight * r[k] / total;
      n[k] += share;
      u[k] += share * p.along;
      square[k] += share * s;
    }
  }
  const double all = n[0] + n[1] + n[2];
  double change = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(n[k] > 1e-9 * all)) continue;
    // The derivative of -2 ln t - (s - 2 u t) / (2 t^2) is 0 where 2 t^2 + u t - s = 0.
    const double mean = u[k] / n[k], t = 0.25 * (-mean + std::sqrt(mean * mean + 8 * square[k] / n[k]));
    change = std::max(change, std::abs(t - fit.position[k]));
    fit.position[k] = t;
    fit.weight[k] = n[k] / all;
  }
  return change;
}

}  // namespace

FootprintFit fit_footprint(const std::vector<FootprintVertex>& vertices) {
  FootprintFit fit;
  for (int i = 0; i < 100; ++i)
    if (improve(fit, vertices) < 1e-5) break;
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return fit.weight[a] > fit.weight[b]; });
  FootprintFit sorted;
  for (std::size_t k = 0; k < 3; ++k) {
    sorted.weight[k] = fit.weight[order[k]];
    sorted.position[k] = fit.position[order[k]];
  }
  return sorted;
}

namespace {

/// What one part of the paths left at one distance.
struct Collected {
  std::vector<FootprintVertex> vertices;
  uint64_t paths = 0;
  double path_weight = 0;
};

void collect(const FootprintOptions& options, const Photon& photon, const std::vector<Vec2>& path,
             std::vector<Collected>& collected) {
  const Vec2 exit(photon.position);
  const double distance = glm::length(exit);
  for (std::size_t i = 0; i < options.distances.size(); ++i) {
    if (std::abs(distance / options.distances[i] - 1) > options.tolerance) continue;
    const double weight = std::pow(options.albedo, static_cast<double>(path.size()));
    ++collected[i].paths;
    collected[i].path_weight += weight;
    const Vec2 axis = exit / distance, side(-axis.y, axis.x);
    for (const Vec2& p : path)
      collected[i].vertices.push_back({static_cast<float>(glm::dot(p, axis) / distance),
                                       static_cast<float>(glm::dot(p, side) / distance),
                                       static_cast<float>(weight)});
  }
}

std::vector<Collected> trace_part(const FootprintOptions& options, uint64_t part, uint64_t paths) {
  std::vector<Collected> collected(options.distances.size());
  Rng rng(options.seed, part);
  const WalkMedium medium{options.g, options.eta};
  std::vector<Vec2> path;
  for (uint64_t i = 0; i < paths; ++i) {
    Photon photon;
    photon.direction = sample_diffuse_entry(options.eta, rng);
    path.clear();
    const auto remember = [&](const Photon& p, Rng&) {
      path.push_back(Vec2(p.position));
      return path.size() <= static_cast<std::size_t>(options.max_order);
    };
    if (walk(HalfSpace{}, medium, photon, rng, remember) == WalkEnd::left)
      collect(options, photon, path, collected);
  }
  return collected;
}

void describe(Footprint& footprint, const std::vector<FootprintVertex>& vertices) {
  footprint.density.assign(static_cast<std::size_t>(Footprint::columns * Footprint::rows), 0);
  double weight = 0, u = 0, uu = 0, vv = 0, inside = 0, gain = 0;
  footprint.fit = fit_footprint(vertices);
  const FootprintFit paper;
  for (const FootprintVertex& p : vertices) {
    weight += p.weight;
    u += p.weight * p.along;
    uu += p.weight * p.along * p.along;
    vv += p.weight * p.across * p.across;
    gain += p.weight * (footprint.fit.log_density(p.along, p.across) - paper.log_density(p.along, p.across));
    const double column = (p.along + 1) / 3 * Footprint::columns, row = (p.across + 1) / 2 * Footprint::rows;
    if (!(column >= 0 && column < Footprint::columns && row >= 0 && row < Footprint::rows)) continue;
    inside += p.weight;
    footprint
        .density[static_cast<std::size_t>(row) * Footprint::columns + static_cast<std::size_t>(column)] +=
        p.weight;
  }
  const double cell = 6.0 / (Footprint::columns * Footprint::rows);
  for (double& d : footprint.density) d /= weight * cell;
  footprint.inside = inside / weight;
  footprint.mean_along = u / weight;
  footprint.deviation_along =
      std::sqrt(std::max(0.0, uu / weight - footprint.mean_along * footprint.mean_along));
  footprint.deviation_across = std::sqrt(vv / weight);
  footprint.log_likelihood_gain = gain / weight;
}

}  // namespace

std::vector<Footprint> measure_footprints(const FootprintOptions& options) {
  constexpr std::size_t parts = 64;
  std::vector<std::vector<Collected>> collected(parts);
  parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      collected[i] = trace_part(options, i, (options.paths + parts - 1) / parts);
  });
  std::vector<Footprint> result(options.distances.size());
  for (std::size_t d = 0; d < result.size(); ++d) {
    std::vector<FootprintVertex> vertices;
    double path_weight = 0, vertex_weight = 0;
    result[d].distance = options.distances[d];
    for (const auto& part : collected) {
      vertices.insert(vertices.end(), part[d].vertices.begin(), part[d].vertices.end());
      result[d].paths += part[d].paths;
      path_weight += part[d].path_weight;
    }
    for (const FootprintVertex& p : vertices) vertex_weight += p.weight;
    if (vertices.empty()) continue;
    result[d].vertices_per_path = vertex_weight / path_weight;
    describe(result[d], vertices);
  }
  return result;
}

}  // namespace alabaster
