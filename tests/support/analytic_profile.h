#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vec.h"
#include "optics/profile_table.h"

/// A profile in closed form, shaped like the baseline's: three exponentials, R = sum a_k lambda_k
/// exp(-lambda_k rho) / (2 pi rho), the last with the diffusion length, A(0) = 0, A(1) = 1.
class AnalyticProfile final : public alabaster::ProfileTable {
 public:
  using ProfileTable::evaluate_over_albedo;
  double g() const override { return 0.3; }
  double eta() const override { return 1.5; }
  double reflectance(double albedo) const override {
    double sum = 0;
    for (const auto& c : components(albedo)) sum += c.amount;
    return albedo * sum;
  }
  double albedo_from_reflectance(double reflectance_wanted) const override {
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (reflectance(middle) < reflectance_wanted ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  double evaluate_over_albedo(double albedo, double rho) const override {
    double sum = 0;
    for (const auto& c : components(albedo)) sum += c.amount * c.rate * std::exp(-c.rate * rho);
    return sum / (2 * alabaster::pi * rho);
  }
  double sample(double albedo, double u) const override {
    const auto list = components(albedo);
    double left = u * reflectance(albedo) / albedo;
    std::size_t k = 0;
    while (k + 1 < list.size() && left >= list[k].amount) left -= list[k++].amount;
    return -std::log1p(-std::min(left / list[k].amount, 1 - 1e-15)) / list[k].rate;
  }
  double pdf(double albedo, double rho) const override {
    double sum = 0, total = 0;
    for (const auto& c : components(albedo)) {
      sum += c.amount * c.rate * std::exp(-c.rate * rho);
      total += c.amount;
    }
    return sum / total;
  }

 private:
  struct Component {
    double amount;  // over albedo
    double rate;
  };
  static std::array<Component, 3> components(double albedo) {
    const double diffusion = std::max(std::sqrt(3 * (1 - albedo) * (1 - 0.3 * albedo)), 0.02);
    return {{{0.05, 4},
             {0.15 * std::pow(albedo, 3), 1.2},
             {0.8 * std::pow(albedo, 39), std::min(diffusion, 1.2)}}};
  }
};
