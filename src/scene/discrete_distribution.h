#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace alabaster {

/// Index i with probability proportional to weight i >= 0, by inversion of the cumulative sum: stratified
/// input stays stratified.
class DiscreteDistribution {
 public:
  DiscreteDistribution() = default;
  explicit DiscreteDistribution(const std::vector<double>& weights) {
    cumulative_.reserve(weights.size() + 1);
    cumulative_.push_back(0);
    for (const double w : weights) cumulative_.push_back(cumulative_.back() + w);
  }

  std::size_t size() const { return cumulative_.empty() ? 0 : cumulative_.size() - 1; }
  double total() const { return cumulative_.empty() ? 0 : cumulative_.back(); }
  double probability(std::size_t i) const { return (cumulative_[i + 1] - cumulative_[i]) / total(); }

  struct Choice {
    std::size_t index = 0;
    double remapped = 0;  // the part of u left over, uniform in [0, 1)
  };
  /// Needs total() > 0; u in [0, 1). Never returns an index of zero weight.
  Choice sample(double u) const {
    const double target = u * total();
    auto it = std::upper_bound(cumulative_.begin() + 1, cumulative_.end(), target);
    // Rounding may push the target onto the total: step back to the last positive weight.
    if (it == cumulative_.end())
      it = std::lower_bound(cumulative_.begin() + 1, cumulative_.end(), cumulative_.back());
    const auto i = static_cast<std::size_t>(it - cumulative_.begin()) - 1;
    const double width = cumulative_[i + 1] - cumulative_[i];
    return {i, std::clamp((target - cumulative_[i]) / width, 0.0, 0x1.fffffffffffffp-1)};
  }

 private:
  std::vector<double> cumulative_;
};

}  // namespace alabaster
