#include "optics/exponential_mixture.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

double ExponentialMixture::density(double rho) const {
  double sum = 0;
  for (const Component& c : components) sum += c.weight * c.rate * std::exp(-c.rate * rho);
  return sum;
}

double ExponentialMixture::total() const {
  double sum = 0;
  for (const Component& c : components) sum += c.weight;
  return sum;
}

double ExponentialMixture::energy(double from, double to) const {
  double sum = 0;
  for (const Component& c : components)
    sum -= c.weight * std::exp(-c.rate * from) * std::expm1(-c.rate * (to - from));
  return sum;
}

double ExponentialMixture::sample(double u) const {
  double rest = u * total();
  for (std::size_t k = 0; k < components.size(); ++k) {
    const Component& c = components[k];
    if (rest < c.weight || k + 1 == components.size())
      return -std::log1p(-std::min(rest / c.weight, 1 - 0x1p-53)) / c.rate;
    rest -= c.weight;
  }
  return 0;
}

void ExponentialMixture::sort() {
  std::sort(components.begin(), components.end(),
            [](const Component& a, const Component& b) { return a.rate < b.rate; });
}

}  // namespace alabaster
