#include "optics/light_aim.h"

#include <algorithm>
#include <cmath>

#include "optics/fast_math.h"
#include "optics/fresnel.h"

namespace alabaster {

namespace {

// I_0(x) for x up to 2.4 from its square, relative error below 1e-6: the power series in (x / 2)^2.
template <typename Float>
Float bessel_i0(Float square) {
  const Float z = 0.25f * square;
  Float sum = z - z + 1.f;
  for (int k = 8; k > 0; --k) sum = 1.f + sum * (z * (1.f / static_cast<float>(k * k)));
  return sum;
}

// I_1(x) / I_0(x)
double mean_cosine(double x) {
  const double z = 0.25 * x * x;
  double zeroth = 1, first = 1;
  for (int k = 16; k > 0; --k) {
    zeroth = 1 + zeroth * z / (k * k);
    first = 1 + first * z / (k * (k + 1));
  }
  return 0.5 * x * first / zeroth;
}

}  // namespace

LightAim::LightAim(const Rgb& concentration, const Vec3& entry, const Vec3& entry_normal, const Vec3& exit,
                   const Vec3& exit_normal, const Vec3& viewer)
    : concentration_(concentration) {
  const Vec3 u = glm::normalize(entry - exit);
  along_ = u - glm::dot(u, entry_normal) * entry_normal;
  across_ = glm::cross(entry_normal, u);
  viewer_along_ = glm::dot(viewer, u - glm::dot(u, exit_normal) * exit_normal);
  viewer_across_ = glm::dot(viewer, glm::cross(exit_normal, u));
}

Rgb LightAim::at(const Vec3& direction) const {
  return factor(glm::dot(along_, direction), glm::dot(across_, direction));
}

Rgb LightAim::mean() const {
  // The root mean square of the sine under T(cos) cos, over the azimuth in six steps: exact to third order.
  constexpr double sine = 0.69, half = 0.5 * sine, root = 0.866025403784 * sine;
  const double a = std::sqrt(glm::dot(along_, along_));
  return (1.0 / 6) *
         (factor(a * sine, 0) + factor(-a * sine, 0) + factor(a * half, a * root) +
          factor(a * half, -a * root) + factor(-a * half, a * root) + factor(-a * half, -a * root));
}

Rgb LightAim::factor(double along, double across) const {
  const auto x = static_cast<float>(along - viewer_along_), y = static_cast<float>(across - viewer_across_);
  const Float4 k{static_cast<float>(concentration_.r), static_cast<float>(concentration_.g),
                 static_cast<float>(concentration_.b), 0};
  constexpr float log2_e = 1.44269504f;
  const Float4 value = fast_exp2(log2_e * x * k) / bessel_i0(k * k * (x * x + y * y));
  return {double{value[0]}, double{value[1]}, double{value[2]}};
}

AimSlopes::AimSlopes(double eta) {
  constexpr int sines = 8, azimuths = 16;
  std::array<double, sines> sine, weight;
  double norm = 0, square = 0;
  for (std::size_t i = 0; i < sines; ++i) {
    const double cosine = std::sqrt((static_cast<double>(i) + 0.5) / sines);
    sine[i] = std::sqrt(1 - cosine * cosine);
    weight[i] = 1 - fresnel_dielectric(cosine, eta);
    norm += weight[i];
    square += 0.5 * weight[i] * sine[i] * sine[i];
  }
  for (int step = 0; step <= steps; ++step) {
    const double k = largest * step / steps;
    double sum = 0;
    // Over the azimuth of u, t . u has the mean |t| I_1(k |t|) / I_0(k |t|); both ends have the same share.
    for (std::size_t i = 0; i < sines; ++i)
      for (std::size_t j = 0; j < sines; ++j)
        for (int a = 0; a < azimuths; ++a) {
          const double cosine = std::cos(pi * (a + 0.5) / azimuths);
          const double t = std::sqrt(sine[i] * sine[i] + sine[j] * sine[j] - 2 * sine[i] * sine[j] * cosine);
          sum += weight[i] * weight[j] * t * mean_cosine(k * t);
        }
    slopes_[static_cast<std::size_t>(step)] = 0.5 * sum / (azimuths * norm * square);
  }
}

double AimSlopes::slope(double concentration) const {
  const double at = std::clamp(concentration / largest, 0.0, 1.0) * steps;
  const auto step = std::min(static_cast<std::size_t>(at), slopes_.size() - 2);
  return slopes_[step] + (at - static_cast<double>(step)) * (slopes_[step + 1] - slopes_[step]);
}

double AimSlopes::concentration(double slope) const {
  if (slope >= slopes_.back()) return largest;
  const auto above = std::upper_bound(slopes_.begin() + 1, slopes_.end(), std::max(slope, 0.0));
  const double fraction = (std::max(slope, 0.0) - above[-1]) / (above[0] - above[-1]);
  return largest / steps * (static_cast<double>(above - slopes_.begin()) - 1 + fraction);
}

}  // namespace alabaster
