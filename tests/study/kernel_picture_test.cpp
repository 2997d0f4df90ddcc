#include "study/kernel_picture.h"

#include <catch2/catch.hpp>

#include "bssrdf/aggregation_kernel.h"
#include "study/footprint.h"

using namespace alabaster;

TEST_CASE("the kernel drawn over a texture is eq. 1's") {
  const FootprintFit eq1;  // written on its own, for the footprints
  double integral = 0;
  constexpr double cell = 0.02;
  for (double along = -3; along < 4; along += cell)
    for (double across = -3; across < 3; across += cell) {
      const double density = kernel_density(ek17_kernel, along + 0.5 * cell, across + 0.5 * cell);
      integral += density * cell * cell;
    }
  CHECK(integral == Approx(1).epsilon(1e-4));
  for (const Vec2 p : {Vec2(0.2, 0), Vec2(0.6, 0.3), Vec2(-0.1, -0.5), Vec2(1, 0)})
    CHECK(kernel_density(ek17_kernel, p.x, p.y) == Approx(eq1.density(p.x, p.y)).epsilon(1e-9));
}

TEST_CASE("a kernel over a texture shows the texture away from it and both points") {
  PlanarScene scene;
  auto texels = std::make_shared<TexelArray>();
  texels->width = 1, texels->height = 1;
  texels->texels = {Vec4f(0.5f, 0.5f, 0.5f, 1)};
  scene.albedo = texels;
  const int size = 200;  // 50 pixels to the distance
  const Vec2 entry(1, 1), exit(1, 3);
  Pixels8 picture = kernel_over_texture(scene, entry, exit, ek17_kernel, size);
  const auto grey = [&](int x, int y) {
    const uint8_t* p = picture.at(x, y);
    return p[0] == p[1] && p[1] == p[2] ? int(p[0]) : -1;
  };
  CHECK(grey(100, 125) == 255);  // the entry, half a distance below the middle
  CHECK(grey(100, 75) == 0);     // the exit
  const uint8_t* corner = picture.at(0, 0);
  CHECK(std::abs(corner[0] - 186) <= 2);  // 0.5 as displayed
  CHECK(std::abs(corner[2] - 186) <= 2);
  // Orange between the points, most of it nearer to the entry; the same on both sides of the line.
  const auto blue = [&](int x, int y) { return int(picture.at(x, y)[2]); };
  CHECK(blue(100, 116) < blue(100, 84));
  CHECK(blue(90, 112) == blue(109, 112));
}
