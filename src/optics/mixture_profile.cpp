#include "optics/mixture_profile.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vec.h"

namespace alabaster {

namespace {

constexpr int size = TableData::mixture_size;
constexpr double defensive_share = 1e-3;

double row_position(double albedo) {
  return AlbedoRows::position(std::clamp(albedo, 0.0, 1.0));
}

}  // namespace

MixtureProfile::MixtureProfile(const TableData& data) : g_(data.g), eta_(data.eta) {
  for (std::size_t k = 0; k < size; ++k) {
    std::vector<double> weights, rates;
    for (std::size_t row = 0; row < AlbedoRows::count; ++row) {
      weights.push_back(data.mixture[row * size + k][0]);
      rates.push_back(data.mixture[row * size + k][1]);
    }
    weights_.emplace_back(std::move(weights));
    rates_.emplace_back(std::move(rates));
  }
}

MixtureProfile::Component MixtureProfile::component(int k, double position) const {
  return {weights_[static_cast<std::size_t>(k)](position), rates_[static_cast<std::size_t>(k)](position)};
}

double MixtureProfile::reflectance(double albedo) const {
  albedo = std::clamp(albedo, 0.0, 1.0);
  double sum = 0;
  for (const MonotoneCurve& weight : weights_) sum += weight(row_position(albedo));
  return albedo * sum;
}

double MixtureProfile::albedo_from_reflectance(double reflectance) const {
  double low = 0, high = AlbedoRows::count - 1;  // positions: high is dark
  for (int step = 0; step < 52; ++step) {
    const double middle = 0.5 * (low + high);
    (this->reflectance(AlbedoRows::albedo(middle)) > reflectance ? low : high) = middle;
  }
  return low == 0 ? 1.0 : AlbedoRows::albedo(high);
}

double MixtureProfile::evaluate_over_albedo(double albedo, double rho) const {
  const double position = row_position(albedo);
  double density = 0;
  for (int k = 0; k < size; ++k) {
    const Component c = component(k, position);
    density += c.weight * c.rate * std::exp(-c.rate * rho);
  }
  return density / (2 * pi * rho);
}

double MixtureProfile::pdf(double albedo, double rho) const {
  const double position = row_position(albedo);
  double density = 0, total = 0;
  for (int k = 0; k < size; ++k) {
    const Component c = component(k, position);
    density += c.weight * c.rate * std::exp(-c.rate * rho);
    total += c.weight;
  }
  return (1 - defensive_share) * density / total + defensive_share / ((1 + rho) * (1 + rho));
}

double MixtureProfile::sample(double albedo, double u) const {
  if (u < defensive_share) {
    const double v = u / defensive_share;
    return v / (1 - v);
  }
  const double position = row_position(albedo);
  std::array<Component, size> components{};
  double total = 0;
  for (int k = 0; k < size; ++k) {
    components[static_cast<std::size_t>(k)] = component(k, position);
    total += components[static_cast<std::size_t>(k)].weight;
  }
  double rest = (u - defensive_share) / (1 - defensive_share) * total;
  const Component* chosen = components.data();
  for (const Component& c : components) {
    if (c.weight <= 0) continue;
    chosen = &c;
    if (rest < c.weight) break;
    rest -= c.weight;
  }
  return -std::log1p(-std::min(rest / chosen->weight, 1 - 0x1p-53)) / chosen->rate;
}

}  // namespace alabaster
