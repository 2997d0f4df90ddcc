#pragma once

#include <memory>
#include <string>

#include "core/rgb.h"
#include "core/vec.h"
#include "scene/medium.h"
#include "texture/texture.h"

namespace alabaster {

/// Uniform radiance from the whole hemisphere on part of the plane z = 0, none elsewhere: E = pi c radiance.
struct PlanarLight {
  enum class Shape { disk, square, plane };  // plane: everywhere
  Shape shape = Shape::disk;
  Vec2 centre{0};     // m
  double radius = 1;  // m; half the side of a square
  Rgb radiance{1};

  bool contains(Vec2 p) const;
  /// m^2; infinity for the whole plane.
  double area() const;
  /// A point uniform by area, u in [0, 1)^2; not for the whole plane.
  Vec2 sample(Vec2 u) const;
};

/// An orthographic view of a rectangle of the plane. Pixels are squares of the surface from any direction
/// (the oblique image is rectified), so that views can be compared pixel by pixel.
struct PlanarView {
  Vec2 centre{0};                 // m
  Vec2 size{10};                  // m
  int width = 100, height = 100;  // pixels; row 0 at the largest y
  Vec3 towards{0, 0, 1};          // unit, from the surface to the camera, z > 0
  bool radiosity = false;         // radiant exitance / pi instead of the radiance in one direction

  /// Point of the plane at image position (x, y) in pixels.
  Vec2 point(Vec2 pixel) const;
  /// Image position in pixels of a point of the plane; may lie outside the image.
  Vec2 pixel(Vec2 point) const;
  double pixel_area() const { return size.x / width * size.y / height; }  // m^2
};

/// The flat laboratory of [EK17]: a half-space below z = 0 whose albedo follows a texture, the same at every
/// depth, repeated in both directions. The texture's tile is centred at the origin, its row 0 at the largest
/// y.
struct PlanarScene {
  std::string name;                          // as on the command line
  std::string title;                         // for people
  std::shared_ptr<const TexelArray> albedo;  // alpha in RGB, linear
  Vec2 tile{10};                             // m, size of one repetition
  Medium medium{Rgb(1), 0.3, 1.5};
  PlanarLight light;
  PlanarView view;

  /// Texture coordinates (one tile is [0, 1)^2, v downwards) of a point of the plane.
  Vec2 uv(Vec2 point) const { return {point.x / tile.x + 0.5, 0.5 - point.y / tile.y}; }
};

/// The same scene with the texture replaced by one albedo.
PlanarScene with_constant_albedo(const PlanarScene& scene, const Rgb& albedo);
/// Mean of the texels.
Rgb mean_albedo(const TexelArray& texels);

/// Throws InputError naming the scene and what is wrong with it (no texture, albedo outside [0, 1], a
/// direction from below, an empty view ...).
void check(const PlanarScene& scene);

}  // namespace alabaster
