#include "integrators/depth_guide.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optics/photon_walk.h"

namespace alabaster {

namespace {

// Moments of the eigenfunction beyond this one are taken to be 0.
constexpr int last_moment = 60;

// The moments phi_l of the eigenfunction obey
//   (2l + 1)(1 - albedo g^l) phi_l = kappa ((l + 1) phi_(l+1) + l phi_(l-1));
// the ratio phi_l / phi_(l-1) by that recursion backwards. For l = 0 it asks for 1 - albedo = kappa ratio(1).
double ratio_of_moments(int l, double g, double albedo, double kappa) {
  double ratio = 0;
  for (int k = last_moment; k >= l; --k) {
    const double rest = (2 * k + 1) * (1 - albedo * std::pow(g, k)) - kappa * (k + 1) * ratio;
    if (!(rest > 0)) return std::numeric_limits<double>::infinity();  // kappa beyond the eigenvalue
    ratio = kappa * k / rest;
  }
  return ratio;
}

// Where `f`, which grows, passes 0.
template <typename Function>
double root(double low, double high, Function&& f) {
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double albedo_of(double g, double kappa) {
  return root(0, 1,
              [&](double albedo) { return kappa * ratio_of_moments(1, g, albedo, kappa) - (1 - albedo); });
}

constexpr double kappa_step = 0.05;

// Coefficients of the powers of x in the Legendre polynomials.
constexpr double legendre[6][6] = {{1, 0, 0, 0, 0, 0},
                                   {0, 1, 0, 0, 0, 0},
                                   {-0.5, 0, 1.5, 0, 0, 0},
                                   {0, -1.5, 0, 2.5, 0, 0},
                                   {0.375, 0, -3.75, 0, 4.375, 0},
                                   {0, 1.875, 0, -8.75, 0, 7.875}};

}  // namespace

double DepthGuide::kappa_of(double g, double albedo) {
  return root(0, largest_kappa,
              [&](double kappa) { return kappa * ratio_of_moments(1, g, albedo, kappa) - (1 - albedo); });
}

DepthGuide::DepthGuide(double g, double kappa) : g_(g), kappa_(kappa) {
  const double albedo = albedo_of(g, kappa);
  double moment = 1, power = 1;
  for (std::size_t l = 0; l < terms; ++l) {
    const auto order = static_cast<int>(l);
    if (l > 0) moment *= ratio_of_moments(order, g, albedo, kappa), power *= g;
    for (std::size_t i = 0; i < terms; ++i) {
      const double term = (2 * order + 1) * moment * legendre[l][i];
      phi_[i] += term;
      mean_phi_[i] += power * term;
    }
  }
  double smallest = phi(-1);
  constexpr int steps = 200;
  for (int i = 0; i <= steps; ++i) {
    const double value = phi(-1 + 2.0 * i / steps);
    smallest = std::min(smallest, value);
    largest_phi_ = std::max(largest_phi_, value);
  }
  // What was cut off may leave too little behind: no direction may be forgotten.
  constexpr double least = 0.1;
  if (smallest < least) {
    const double lift = least - smallest;
    phi_[0] += lift, mean_phi_[0] += lift, largest_phi_ += lift;
  }
  largest_phi_ *= 1.001;  // between the steps
}

// The phase function's directions, of which phi / its largest value are kept.
Vec3 DepthGuide::scatter(const Vec3& direction, const Vec3& normal, Rng& rng) const {
  const double mu = glm::dot(direction, normal), sine = std::sqrt(std::max(0.0, 1 - mu * mu));
  for (;;) {
    const double cosine = sample_henyey_greenstein(rng.uniform(), g_);
    const double turn = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const Vec2 azimuth = sample_azimuth(rng);  // counted from the normal's side
    if (rng.uniform() * largest_phi_ >= phi(mu * cosine + sine * turn * azimuth.x)) continue;
    const Vec3 tangent = sine > 1e-6 ? (normal - mu * direction) / sine : Frame(direction).tangent;
    const Vec3 turned =
        cosine * direction + turn * (azimuth.x * tangent + azimuth.y * glm::cross(direction, tangent));
    // One Newton step keeps the length at 1 over millions of turns.
    return turned * (1.5 - 0.5 * glm::dot(turned, turned));
  }
}

namespace {

// The slope of the logarithm of sinh(kappa r) / r.
double slope(double kappa, double r) {
  const double x = kappa * r;
  if (std::isinf(r)) return kappa;
  return x < 1e-2 ? kappa * x / 3 : kappa / std::tanh(x) - 1 / r;
}

}  // namespace

DepthGuides::DepthGuides(double g, double radius) : columns_(65) {
  const auto steps = static_cast<int>(std::lround(DepthGuide::largest_kappa / kappa_step));
  for (int i = 0; i <= steps; ++i) guides_.emplace_back(g, i * kappa_step);
  // Beyond ten lengths of decay nothing changes any more.
  constexpr double deepest = 10 / kappa_step;
  const double depth_step = std::min(radius, deepest) / Column::last_depth;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const double darkness = static_cast<double>(i) / static_cast<double>(columns_.size() - 1);
    const double kappa = DepthGuide::kappa_of(g, 1 - darkness * darkness);
    columns_[i].per_depth_ = 1 / depth_step;
    columns_[i].typical_weight_ = std::max(0.01, (1 - darkness) * (1 - darkness));
    double decay = 0;
    for (std::size_t k = 0; k < columns_[i].choices_.size(); ++k) {
      const double local = slope(kappa, std::max(0.0, radius - static_cast<double>(k) * depth_step));
      const auto number = static_cast<std::size_t>(std::lround(local / kappa_step));
      columns_[i].choices_[k] = {number == 0 ? nullptr : &guides_[number], std::exp(-decay)};
      decay += local * depth_step;
    }
  }
}

const DepthGuides::Column& DepthGuides::column(double darkness) const {
  const auto last = static_cast<double>(columns_.size() - 1);
  return columns_[static_cast<std::size_t>(std::lround(std::clamp(darkness, 0.0, 1.0) * last))];
}

}  // namespace alabaster
