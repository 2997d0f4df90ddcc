#pragma once

#include <vector>

namespace alabaster {

/// A cubic through equidistant points x = 0, 1, 2, ... that is monotone where the values are, with a
/// continuous derivative. Fritsch & Carlson 1980, "Monotone Piecewise Cubic Interpolation", with the
/// harmonic-mean slopes of Fritsch & Butland 1984.
class MonotoneCurve {
 public:
  /// At least two values.
  explicit MonotoneCurve(std::vector<double> values);

  /// x is clamped to [0, size - 1].
  double operator()(double x) const;
  /// The x at which the curve takes `value`; values must be decreasing or increasing throughout. Clamped.
  double inverse(double value) const;

 private:
  double segment(std::size_t i, double t) const;

  std::vector<double> values_, slopes_;
};

}  // namespace alabaster
