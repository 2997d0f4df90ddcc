#include "image/false_colour.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace alabaster;

namespace {

// CIE lightness, 0 to 100.
double lightness(const Rgb& c) {
  const double y = luminance(c);
  return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

}  // namespace

TEST_CASE("colour maps grow evenly in lightness and stay inside sRGB") {
  double last = -1;
  for (int i = 0; i <= 100; ++i) {
    const Rgb c = sequential_colour(i / 100.0);
    CHECK(c.min() >= 0);
    CHECK(c.max() <= 1);
    CHECK(lightness(c) > last);
    last = lightness(c);
    CHECK(lightness(diverging_colour(i / 100.0)) ==
          Approx(lightness(diverging_colour(-i / 100.0))).margin(6));
  }
  CHECK(lightness(sequential_colour(0)) < 15);
  CHECK(lightness(sequential_colour(1)) > 90);
  const Rgb neutral = diverging_colour(0);
  CHECK(neutral.max() - neutral.min() < 0.01);
  CHECK(diverging_colour(-1).b > diverging_colour(-1).r);
  CHECK(diverging_colour(1).r > diverging_colour(1).b);
}

TEST_CASE("scales: linear, signed, logarithmic, and back") {
  CHECK(ColourScale{1, 3}.position(2) == Approx(0.5));
  CHECK(ColourScale{1, 3}.position(9) == 1);
  CHECK(ColourScale{0, 4, true}.position(-2) == Approx(-0.5));
  const ColourScale decades{0.01, 100, false, true};
  CHECK(decades.position(1) == Approx(0.5));
  CHECK(decades.position(0) == 0);
  CHECK(decades.position(-5) == 0);
  const ColourScale both{0.01, 100, true, true};
  CHECK(both.position(-1) == Approx(-0.5));
  CHECK(both.position(0) == 0);
  for (const ColourScale& scale : {ColourScale{1, 3}, ColourScale{0, 4, true}, decades, both})
    for (const double t : {0.25, 0.5, 1.0}) CHECK(scale.position(scale.value_at(t)) == Approx(t));
  CHECK(decades.colour(std::nan("")) == Rgb(1, 0, 1));
}

TEST_CASE("a fitted scale ignores outliers and survives empty input") {
  std::vector<float> values(1000, 0.5f);
  values[3] = 1e9f;
  values[4] = NAN;
  CHECK(fitted_scale(values, true).high == Approx(0.5));
  CHECK(fitted_scale({}, false).high == 1);
  CHECK(fitted_scale(std::vector<float>(5, 0.0f), false).high == 1);
}

TEST_CASE("the legend is drawn below the picture and leaves it as it is") {
  const std::vector<float> values(200 * 3, -1.0f);
  const ColourScale scale{0, 1, true};
  const Pixels8 picture = false_colour(values, 200, 3, scale);
  Pixels8 legend = with_legend(picture, scale);
  CHECK(legend.width == 200);
  CHECK(legend.height > 20);
  CHECK(std::equal(picture.bytes.begin(), picture.bytes.end(), legend.bytes.begin()));
  // The bar starts with the colour of -1; its numbers leave dark dots below.
  CHECK(std::abs(legend.at(0, 10)[2] - picture.bytes[2]) < 4);
  int dark = 0;
  for (int y = 20; y < legend.height; ++y)
    for (int x = 0; x < 200; ++x)
      if (legend.at(x, y)[0] == 0) ++dark;
  CHECK(dark > 40);
}
