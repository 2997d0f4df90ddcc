#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/rng.h"
#include "core/statistics.h"
#include "core/vec.h"

/// Chi-square test of a sampler of directions against its density. Cells are equal steps of the cosine with
/// `axis` and of the angle around it; what the sampler refuses to draw is one more cell, expected with the
/// mass that the density lacks. Returns the p-value.
struct SphereChiSquare {
  using Sample = std::function<std::optional<alabaster::Vec3>(alabaster::Vec2)>;
  using Pdf = std::function<double(const alabaster::Vec3&)>;

  alabaster::Vec3 axis{0, 0, 1};
  double least_cosine = -1;  // only directions above it belong to cells; all others share one
  int rows = 16, columns = 24;
  int quadrature = 24;  // points per side of a cell
  int samples = 100000;
  uint64_t seed = 1;
  double mass = 0;  // found by test(): the integral of the density over the cells

  double test(const Sample& sample, const Pdf& pdf) {
    using namespace alabaster;
    const Frame frame(axis);
    const auto cells = static_cast<std::size_t>(rows * columns);
    std::vector<double> observed(cells + 1, 0), expected(cells + 1, 0);
    Rng rng(seed);
    for (int i = 0; i < samples; ++i) {
      const Vec2 u(rng.uniform(), rng.uniform());
      const auto direction = sample(u);
      observed[direction ? cell_of(frame.to_local(*direction)) : cells] += 1;
    }
    mass = 0;
    const double step = (1 - least_cosine) / rows, turn = 2 * pi / columns;
    const double share = step * turn / (quadrature * quadrature);
    for (int r = 0; r < rows * quadrature; ++r) {
      const double z = least_cosine + (r + 0.5) / quadrature * step;
      const double s = std::sqrt(std::max(0.0, 1 - z * z));
      for (int c = 0; c < columns * quadrature; ++c) {
        const double phi = (c + 0.5) / quadrature * turn;
        const double p = pdf(frame.to_world({s * std::cos(phi), s * std::sin(phi), z})) * share;
        mass += p;
        expected[static_cast<std::size_t>((r / quadrature) * columns + c / quadrature)] += p * samples;
      }
    }
    expected[cells] = std::max(0.0, 1 - mass) * samples;
    return p_value(observed, expected);
  }

 private:
  std::size_t cell_of(const alabaster::Vec3& local) const {
    const auto cells = static_cast<std::size_t>(rows * columns);
    const double row = (local.z - least_cosine) / (1 - least_cosine) * rows;
    if (row < 0) return cells;
    double turn = std::atan2(local.y, local.x) / (2 * alabaster::pi);
    turn -= std::floor(turn);
    const int r = std::min(static_cast<int>(row), rows - 1);
    const int c = std::min(static_cast<int>(turn * columns), columns - 1);
    return static_cast<std::size_t>(r * columns + c);
  }

  /// Cells expected to hold fewer than 5 are pooled.
  static double p_value(const std::vector<double>& observed, const std::vector<double>& expected) {
    double statistic = 0, pooled_observed = 0, pooled_expected = 0;
    int degrees = -1;
    for (std::size_t i = 0; i < observed.size(); ++i) {
      if (expected[i] < 5) {
        pooled_observed += observed[i], pooled_expected += expected[i];
        continue;
      }
      statistic += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
      ++degrees;
    }
    if (pooled_expected >= 5) {
      statistic +=
          (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
      ++degrees;
    } else if (pooled_observed > pooled_expected + 10 * std::sqrt(pooled_expected + 1)) {
      return 0;  // samples where the density says there are none
    }
    return alabaster::chi_square_p_value(statistic, degrees);
  }
};
