#include "study/method_result.h"

#include <cmath>

namespace alabaster {

double noise_of(const Image& image) {
  const auto colour = find_layer(image, ""), deviation = find_layer(image, "variance");
  double variance = 0, square = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Rgb c = colour->get(image, x, y);
      variance += deviation->get(image, x, y).mean();
      square += (c * c).mean();
    }
  return square > 0 ? std::sqrt(variance / square) : 0;
}

}  // namespace alabaster
