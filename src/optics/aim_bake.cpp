#include "optics/aim_bake.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/parallel.h"
#include "optics/order_groups.h"

namespace alabaster {

namespace {

constexpr uint64_t chunk_photons = 1 << 13;
constexpr double unit = 1 << 20;  // of the integers in which cosines are summed, so that their order is free
constexpr int cells = OrderGroups::count * AimGrid::nodes;

struct Tally {
  std::vector<int64_t> count = std::vector<int64_t>(cells), cosine = std::vector<int64_t>(cells);
};

void walk_photon(const WalkMedium& medium, Rng& rng, Tally& tally) {
  Photon photon;
  photon.direction = sample_diffuse_entry(medium.eta, rng);
  // Long paths are followed more and more seldom, and count for more.
  int64_t limit = 256, weight = 1;
  const WalkEnd end = walk(HalfSpace(), medium, photon, rng, [&](const Photon& p, Rng& random) {
    if (p.order < limit) return true;
    limit *= 4;
    weight *= 2;
    return p.order < OrderGroups::limit && random.uniform() < 0.5;
  });
  if (end == WalkEnd::stopped || photon.order == 0) return;
  const double rho = std::hypot(photon.position.x, photon.position.y);
  const double position = std::clamp(AimGrid::position(std::log2(rho)), 0.0, AimGrid::nodes - 1.0);
  const auto cell = static_cast<std::size_t>(OrderGroups::index(photon.order) * AimGrid::nodes +
                                             static_cast<int>(std::lround(position)));
  // Snell's law leaves the sine times eta.
  const double along =
      medium.eta * (photon.direction.x * photon.position.x + photon.direction.y * photon.position.y) / rho;
  tally.count[cell] += weight;
  tally.cosine[cell] += weight * std::llround(unit * along);
}

// The mean of (w . u)^2 over the Fresnel-weighted cosine, u in the surface.
double mean_square(double eta) {
  double sum = 0, norm = 0;
  for (int i = 0; i < 4096; ++i) {
    const double mu = (i + 0.5) / 4096, weight = mu * (1 - fresnel_dielectric(mu, eta));
    sum += 0.5 * weight * (1 - mu * mu);
    norm += weight;
  }
  return sum / norm;
}

// Whittaker's smoothing over the nodes of one row: bends of a tenth are typical.
Eigen::VectorXd smooth(const Eigen::VectorXd& measured, const Eigen::VectorXd& certainty) {
  const Eigen::Index n = measured.size();
  Eigen::MatrixXd matrix = certainty.asDiagonal();
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    matrix(i, i) += 1, matrix(i + 1, i + 1) += 1;
    matrix(i, i + 1) -= 1, matrix(i + 1, i) -= 1;
  }
  const double stencil[3] = {1, -2, 1};
  for (Eigen::Index i = 0; i + 2 < n; ++i)
    for (Eigen::Index a = 0; a < 3; ++a)
      for (Eigen::Index b = 0; b < 3; ++b) matrix(i + a, i + b) += 100 * stencil[a] * stencil[b];
  return matrix.ldlt().solve(certainty.cwiseProduct(measured));
}

}  // namespace

std::vector<double> bake_aim(const WalkMedium& medium, uint64_t photons, uint64_t seed) {
  Tally total;
  std::mutex mutex;
  const uint64_t chunks = (photons + chunk_photons - 1) / chunk_photons;
  parallel_for(chunks, (chunks + 7) / 8, [&](std::size_t begin, std::size_t end) {
    Tally part;
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
      Rng rng(seed, chunk);
      for (uint64_t k = 0; k < chunk_photons; ++k) walk_photon(medium, rng, part);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (std::size_t i = 0; i < cells; ++i)
      total.count[i] += part.count[i], total.cosine[i] += part.cosine[i];
  });
  const double square = mean_square(medium.eta);
  std::vector<double> result(static_cast<std::size_t>(AimGrid::nodes * ShapeGrid::rows));
  for (int row = 0; row < ShapeGrid::rows; ++row) {
    const double albedo = ShapeGrid::albedo(row);
    Eigen::VectorXd measured(AimGrid::nodes), certainty(AimGrid::nodes);
    for (int node = 0; node < AimGrid::nodes; ++node) {
      double cosine = 0, light = 0, light_square = 0;
      for (int group = 1; group < OrderGroups::count; ++group) {
        const auto cell = static_cast<std::size_t>(group * AimGrid::nodes + node);
        const double score = OrderGroups::mean_power(group, albedo);
        const auto count = static_cast<double>(total.count[cell]);
        cosine += score * static_cast<double>(total.cosine[cell]) / unit;
        light += score * count;
        light_square += score * score * count;
      }
      measured[node] = light > 0 ? cosine / (light * square) : 0;
      certainty[node] = light > 0 ? square * light * light / light_square : 0;  // 1 / variance
    }
    const Eigen::VectorXd nodes = smooth(measured, certainty);
    for (int node = 0; node < AimGrid::nodes; ++node)
      result[AimGrid::index(node, row)] = std::clamp(nodes[node], 0.0, 2.0);
  }
  return result;
}

}  // namespace alabaster
