#pragma once

#include <cmath>
#include <functional>
#include <memory>

#include "integrators/planar_scene.h"

/// A small flat scene: a texture from a function of the texel, a lit disk of radius 1.2 m in a view of 4 x 4
/// m.
inline alabaster::PlanarScene small_planar_scene(int texels,
                                                 const std::function<alabaster::Rgb(int, int)>& albedo) {
  using namespace alabaster;
  auto array = std::make_shared<TexelArray>();
  array->width = array->height = texels;
  for (int y = 0; y < texels; ++y)
    for (int x = 0; x < texels; ++x) {
      const Rgb a = albedo(x, y);
      array->texels.push_back(Vec4f(Vec4(a.r, a.g, a.b, 1)));
    }
  PlanarScene scene;
  scene.name = "test";
  scene.albedo = std::move(array);
  scene.tile = Vec2(4);
  scene.light.radius = 1.8;
  scene.view.size = Vec2(4);
  scene.view.width = scene.view.height = 8;
  return scene;
}

inline alabaster::PlanarScene constant_planar_scene(double albedo) {
  return small_planar_scene(1, [=](int, int) { return alabaster::Rgb(albedo); });
}

/// Two-tone stripes along y, `periods` to the tile.
inline alabaster::PlanarScene striped_planar_scene(double bright, double dark, int periods = 4,
                                                   int texels = 32) {
  return small_planar_scene(texels, [=](int x, int) {
    return alabaster::Rgb((2 * periods * x / texels) % 2 == 0 ? bright : dark);
  });
}

/// Differently coloured patches without any symmetry.
inline alabaster::PlanarScene coloured_planar_scene() {
  return small_planar_scene(16, [](int x, int y) {
    return alabaster::Rgb(x < 5 ? 0.97 : 0.6, (x + 2 * y) % 5 < 2 ? 0.9 : 0.7, y < 9 ? 0.8 : 0.95);
  });
}
