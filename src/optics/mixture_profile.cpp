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

MixtureProfile::MixtureProfile(const TableData& data)
    : g_(data.g), eta_(data.eta), reflectance_over_albedo_(data.reflectance_over_albedo) {
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

std::array<MixtureProfile::Component, size> MixtureProfile::components(double position) const {
  std::array<Component, size> result{};
  double total = 0;
  for (std::size_t k = 0; k < size; ++k) {
    result[k] = {weights_[k](position), rates_[k](position)};
    total += result[k].weight;
  }
  const double scale = reflectance_over_albedo_(position) / total;
  for (Component& c : result) c.weight *= scale;
  return result;
}

double MixtureProfile::reflectance(double albedo) const {
  albedo = std::clamp(albedo, 0.0, 1.0);
  return albedo * reflectance_over_albedo_(row_position(albedo));
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
  double density = 0;
  for (const Component& c : components(row_position(albedo)))
    density += c.weight * c.rate * std::exp(-c.rate * rho);
  return density / (2 * pi * rho);
}

double MixtureProfile::pdf(double albedo, double rho) const {
  const double position = row_position(albedo);
  double density = 0;
  for (const Component& c : components(position)) density += c.weight * c.rate * std::exp(-c.rate * rho);
  return (1 - defensive_share) * density / reflectance_over_albedo_(position) +
         defensive_share / ((1 + rho) * (1 + rho));
}

double MixtureProfile::sample(double albedo, double u) const {
  if (u < defensive_share) {
    const double v = u / defensive_share;
    return v / (1 - v);
  }
  const double position = row_position(albedo);
  const std::array<Component, size> all = components(position);
  double rest = (u - defensive_share) / (1 - defensive_share) * reflectance_over_albedo_(position);
  const Component* chosen = all.data();
  for (const Component& c : all) {
    if (c.weight <= 0) continue;
    chosen = &c;
    if (rest < c.weight) break;
    rest -= c.weight;
  }
  return -std::log1p(-std::min(rest / chosen->weight, 1 - 0x1p-53)) / chosen->rate;
}

}  // namespace alabaster
