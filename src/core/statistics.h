#pragma once

#include <cmath>
#include <cstdint>

namespace alabaster {

/// Mean and variance of a stream of values (Welford 1962).
class RunningMoments {
 public:
  void add(double value) {
    ++count_;
    const double delta = value - mean_;
    mean_ += delta / static_cast<double>(count_);
    sum_of_squares_ += delta * (value - mean_);
  }
  int64_t count() const { return count_; }
  double mean() const { return mean_; }
  /// Unbiased sample variance; 0 for fewer than two values.
  double variance() const { return count_ > 1 ? sum_of_squares_ / static_cast<double>(count_ - 1) : 0.0; }
  double variance_of_mean() const { return count_ > 0 ? variance() / static_cast<double>(count_) : 0.0; }
  double standard_error() const { return std::sqrt(variance_of_mean()); }

 private:
  int64_t count_ = 0;
  double mean_ = 0, sum_of_squares_ = 0;
};

/// P(Z > |z|) * 2 of a standard normal.
double two_sided_normal_p_value(double z);
/// P(X > statistic) of a chi-square variable with that many degrees of freedom.
double chi_square_p_value(double statistic, double degrees_of_freedom);
/// Significance for each of `tests` so that all together keep `alpha` (Sidak 1967).
double sidak(double alpha, double tests);

}  // namespace alabaster
