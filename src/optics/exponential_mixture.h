#pragma once

#include <vector>

namespace alabaster {

/// A radial profile in the form of [CB15]: R(rho) = sum_k a_k lambda_k exp(-lambda_k rho) / (2 pi rho), a_k
/// >= 0. Each component integrates over the plane to a_k. Below, "density" is 2 pi rho R, per unit rho.
struct ExponentialMixture {
  struct Component {
    double weight;  // a_k
    double rate;    // lambda_k, per mean free path
  };
  std::vector<Component> components;

  double density(double rho) const;
  /// Sum of the weights.
  double total() const;
  /// Energy between two distances, 0 <= from <= to.
  double energy(double from, double to) const;
  /// Draws rho from density / total, u in [0, 1): the component and the exponential from one number.
  double sample(double u) const;
  /// Rates in increasing order.
  void sort();
};

}  // namespace alabaster
