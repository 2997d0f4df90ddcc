#include "optics/profile_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/rng.h"

namespace alabaster {

FitData fit_data(const std::vector<Estimate>& radial_energy, double total, double nearest, double farthest,
                 double worst_error) {
  assert(radial_energy.size() == RadialBins::count);
  FitData data;
  data.total = total;
  for (int first = 1; first + fit_bin - 1 <= RadialBins::inner; first += fit_bin) {
    FitData::Bin bin{RadialBins::edge(first), RadialBins::edge(first + fit_bin), 0, 0};
    if (bin.from < nearest || bin.to > farthest) continue;
    double variance = 0;
    for (int i = first; i < first + fit_bin; ++i) {
      const Estimate& e = radial_energy[static_cast<std::size_t>(i)];
      bin.energy += e.value;
      variance += e.standard_error * e.standard_error;
    }
    if (bin.energy <= 0) continue;
    bin.relative_error = std::sqrt(variance) / bin.energy;
    if (bin.relative_error <= worst_error) data.bins.push_back(bin);
  }
  return data;
}

FitData fit_data(const std::vector<double>& log_density, double total, double nearest, double farthest) {
  std::vector<Estimate> energy(RadialBins::count);
  for (int bin = 1; bin <= RadialBins::inner; ++bin)
    energy[static_cast<std::size_t>(bin)].value =
        std::exp(log_density[static_cast<std::size_t>(bin) - 1]) * RadialBins::width(bin);
  return fit_data(energy, total, nearest, farthest, 1);
}

double diffusion_length(double albedo, double g) {
  return 1 / std::sqrt(3 * (1 - albedo) * (1 - g * albedo));
}

namespace {

// Objective values of a mixture whose components' energies per bin are kept, so that moving one component
// costs one exponential per bin edge.
class Annealer {
 public:
  Annealer(const FitData& data, const AnnealingOptions& options, const ExponentialMixture& start)
      : data_(data), options_(options), rng_(options.seed) {
    for (const ExponentialMixture::Component& c : start.components) {
      log_rate_.push_back(std::log(c.rate));
      log_weight_.push_back(std::log(std::max(c.weight, 1e-9 * data.total)));
    }
    shares_.assign(log_rate_.size(), std::vector<double>(data.bins.size()));
    for (std::size_t k = 0; k < log_rate_.size(); ++k) fill(log_rate_[k], shares_[k]);
    // Slower than that a component is flat over all bins; faster, it would hide its weight before the first.
    slowest_ = std::log(0.1 / data.bins.back().to);
    fastest_ = std::log(1 / data.bins.front().from);
    lightest_ = std::log(1e-5 * data.total);
    for (double& weight : log_weight_) weight = std::max(weight, lightest_);
    best_value_ = value_ = objective();
    best_rate_ = log_rate_, best_weight_ = log_weight_;
  }

  ExponentialMixture run() {
    std::vector<double> saved(data_.bins.size());
    for (int step = 0; step < options_.steps; ++step) {
      const double left = 1 - static_cast<double>(step) / options_.steps;
      // The last fifth is greedy, with small moves.
      const double temperature = options_.start_temperature * value_ * std::pow(std::max(0.0, left - 0.2), 2);
      const double size = options_.step_size * std::pow(left, 3) + 1e-3;
      const std::size_t k = static_cast<std::size_t>(rng_.next() % log_rate_.size());
      const bool moves_rate = rng_.uniform() < 0.5;
      std::vector<double>& parameter = moves_rate ? log_rate_ : log_weight_;
      const double before = parameter[k];
      parameter[k] += size * normal();
      // A component whose weight dwindled to nothing would never be found again.
      parameter[k] = moves_rate ? std::clamp(parameter[k], slowest_, fastest_)
                                : std::clamp(parameter[k], lightest_, lightest_ + std::log(1e6));
      if (moves_rate) {
        saved.swap(shares_[k]);
        shares_[k].resize(data_.bins.size());
        fill(log_rate_[k], shares_[k]);
      }
      const double value = objective();
      const bool accept =
          value <= value_ || (temperature > 0 && rng_.uniform() < std::exp((value_ - value) / temperature));
      if (accept) {
        value_ = value;
        if (value < best_value_) best_value_ = value, best_rate_ = log_rate_, best_weight_ = log_weight_;
      } else {
        parameter[k] = before;
        if (moves_rate) saved.swap(shares_[k]);
      }
    }
    ExponentialMixture result;
    double sum = 0;
    for (const double w : best_weight_) sum += std::exp(w);
    for (std::size_t k = 0; k < best_rate_.size(); ++k)
      result.components.push_back({std::exp(best_weight_[k]) / sum * data_.total, std::exp(best_rate_[k])});
    return result;
  }

 private:
  double normal() {
    return std::sqrt(-2 * std::log(rng_.uniform_positive())) * std::cos(2 * pi * rng_.uniform());
  }

  void fill(double log_rate, std::vector<double>& share) {
    const double rate = std::exp(log_rate);
    double upper = data_.bins.empty() ? 0 : std::exp(-rate * data_.bins[0].from);
    double end = data_.bins.empty() ? 0 : data_.bins[0].from;
    for (std::size_t i = 0; i < share.size(); ++i) {
      if (data_.bins[i].from != end) upper = std::exp(-rate * data_.bins[i].from);
      const double lower = std::exp(-rate * data_.bins[i].to);
      share[i] = upper - lower;
      upper = lower;
      end = data_.bins[i].to;
    }
  }

  double objective() const {
    double sum_of_weights = 0;
    double weights[16];
    const std::size_t n = log_weight_.size();
    for (std::size_t k = 0; k < n; ++k) sum_of_weights += weights[k] = std::exp(log_weight_[k]);
    const double scale = data_.total / sum_of_weights;
    double result = 0;
    for (std::size_t i = 0; i < data_.bins.size(); ++i) {
      double model = 0;
      for (std::size_t k = 0; k < n; ++k) model += weights[k] * shares_[k][i];
      model *= scale;
      const FitData::Bin& bin = data_.bins[i];
      if (options_.objective == FitObjective::ratio) {
        result += model > 0 ? std::max(model / bin.energy, bin.energy / model) - 1 : 1e30;
      } else {
        // Over the plane: (difference of R)^2 x area, R = energy / area.
        const double area = pi * (bin.to * bin.to - bin.from * bin.from);
        result += (model - bin.energy) * (model - bin.energy) / area;
      }
    }
    return options_.objective == FitObjective::ratio ? result / static_cast<double>(data_.bins.size())
                                                     : result;
  }

  const FitData& data_;
  AnnealingOptions options_;
  Rng rng_;
  std::vector<double> log_rate_, log_weight_, best_rate_, best_weight_;
  std::vector<std::vector<double>> shares_;
  double value_ = 0, best_value_ = 0, slowest_ = 0, fastest_ = 0, lightest_ = 0;
};

ExponentialMixture geometric_rates(int components, double slowest, double fastest, double total) {
  ExponentialMixture mixture;
  for (int k = 0; k < components; ++k) {
    const double t = components > 1 ? static_cast<double>(k) / (components - 1) : 0.5;
    mixture.components.push_back({total / components, slowest * std::pow(fastest / slowest, t)});
  }
  return mixture;
}

// Minimises |A x - b| over x >= 0 (Lawson & Hanson 1974, chapter 23).
Eigen::VectorXd non_negative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const Eigen::Index n = a.cols();
  const Eigen::MatrixXd gram = a.transpose() * a;
  const Eigen::VectorXd right = a.transpose() * b;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<bool> free(static_cast<std::size_t>(n));
  const auto solve_free = [&] {
    std::vector<Eigen::Index> indices;
    for (Eigen::Index i = 0; i < n; ++i)
      if (free[static_cast<std::size_t>(i)]) indices.push_back(i);
    const auto m = static_cast<Eigen::Index>(indices.size());
    Eigen::MatrixXd part(a.rows(), m);
    for (Eigen::Index i = 0; i < m; ++i) part.col(i) = a.col(indices[static_cast<std::size_t>(i)]);
    const Eigen::VectorXd solution = part.colPivHouseholderQr().solve(b);
    Eigen::VectorXd whole = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < m; ++i) whole[indices[static_cast<std::size_t>(i)]] = solution[i];
    return whole;
  };
  for (int round = 0; round < 3 * n; ++round) {
    const Eigen::VectorXd gradient = right - gram * x;
    Eigen::Index entering = -1;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!free[static_cast<std::size_t>(i)] && gradient[i] > 1e-10 * std::abs(right[i]) &&
          (entering < 0 || gradient[i] > gradient[entering]))
        entering = i;
    if (entering < 0) break;
    free[static_cast<std::size_t>(entering)] = true;
    Eigen::VectorXd candidate = solve_free();
    while (candidate.minCoeff() < 0) {
      // As far towards the candidate as all stay non-negative; what reaches 0 is fixed there.
      double step = 1;
      for (Eigen::Index i = 0; i < n; ++i)
        if (candidate[i] < 0) step = std::min(step, x[i] / (x[i] - candidate[i]));
      x += step * (candidate - x);
      for (Eigen::Index i = 0; i < n; ++i)
        if (candidate[i] < 0 && x[i] <= 1e-14) {
          free[static_cast<std::size_t>(i)] = false;
          x[i] = 0;
        }
      candidate = solve_free();
    }
    x = candidate;
  }
  return x;
}

}  // namespace

ExponentialMixture fit_by_annealing(const FitData& data, const AnnealingOptions& options,
                                    const ExponentialMixture& start) {
  assert(options.components >= 1 && options.components <= 16);
  assert(!data.bins.empty());
  ExponentialMixture initial = start;
  if (initial.components.empty())
    initial = geometric_rates(options.components, 3 / data.bins.back().to, 5.0, data.total);
  ExponentialMixture result = Annealer(data, options, initial).run();
  if (start.components.empty()) result.sort();
  return result;
}

ExponentialMixture fit_by_least_squares(const FitData& data, int components, double slowest, double fastest) {
  ExponentialMixture mixture = geometric_rates(components, slowest, fastest, data.total);
  const auto rows = static_cast<Eigen::Index>(data.bins.size());
  Eigen::MatrixXd a(rows + 1, components);
  const double heavy = 1e3 * std::sqrt(static_cast<double>(rows));
  for (int k = 0; k < components; ++k) {
    const ExponentialMixture unit{{{1, mixture.components[static_cast<std::size_t>(k)].rate}}};
    for (Eigen::Index i = 0; i < rows; ++i) {
      const FitData::Bin& bin = data.bins[static_cast<std::size_t>(i)];
      a(i, k) = unit.energy(bin.from, bin.to) / bin.energy;
    }
    a(rows, k) = heavy / data.total;
  }
  Eigen::VectorXd b = Eigen::VectorXd::Ones(rows + 1);
  b[rows] = heavy;
  const Eigen::VectorXd weights = non_negative_least_squares(a, b);
  for (int k = 0; k < components; ++k) mixture.components[static_cast<std::size_t>(k)].weight = weights[k];
  return mixture;
}

FitError fit_error(const ExponentialMixture& mixture, const FitData& data) {
  FitError error;
  for (const FitData::Bin& bin : data.bins) {
    const double relative = std::abs(mixture.energy(bin.from, bin.to) / bin.energy - 1);
    error.mean += relative;
    error.largest = std::max(error.largest, relative);
  }
  if (!data.bins.empty()) error.mean /= static_cast<double>(data.bins.size());
  error.total = mixture.total() / data.total - 1;
  return error;
}

}  // namespace alabaster
