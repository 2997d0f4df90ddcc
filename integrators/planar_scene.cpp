#include "integrators/planar_scene.h"

#include <cmath>
#include <limits>

#include "core/error.h"

namespace alabaster {

bool PlanarLight::contains(Vec2 p) const {
  const Vec2 offset = p - centre;
  switch (shape) {
    case Shape::disk:
      return glm::dot(offset, offset) < radius * radius;
    case Shape::square:
      return std::abs(offset.x) < radius && std::abs(offset.y) < radius;
    case Shape::plane:
      break;
  }
  return true;
}

double PlanarLight::area() const {
  switch (shape) {
    case Shape::disk:
      return pi * radius * radius;
    case Shape::square:
      return 4 * radius * radius;
    case Shape::plane:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

Vec2 PlanarLight::sample(Vec2 u) const {
  if (shape == Shape::square) return centre + radius * (2.0 * u - 1.0);
  const double r = radius * std::sqrt(u.x), angle = 2 * pi * u.y;
  return centre + r * Vec2(std::cos(angle), std::sin(angle));
}

Vec2 PlanarView::point(Vec2 p) const {
  return centre + size * Vec2(p.x / width - 0.5, 0.5 - p.y / height);
}

Vec2 PlanarView::pixel(Vec2 p) const {
  const Vec2 relative = (p - centre) / size;
  return {(relative.x + 0.5) * width, (0.5 - relative.y) * height};
}

PlanarScene with_constant_albedo(const PlanarScene& scene, const Rgb& albedo) {
  PlanarScene result = scene;
  auto texel = std::make_shared<TexelArray>();
  texel->width = texel->height = 1;
  texel->texels = {Vec4f(Vec4(albedo.r, albedo.g, albedo.b, 1))};
  result.albedo = std::move(texel);
  return result;
}

Rgb mean_albedo(const TexelArray& texels) {
  Rgb sum;
  for (const Vec4f& t : texels.texels) sum += Rgb(t.x, t.y, t.z);
  return sum / static_cast<double>(texels.texels.size());
}

namespace {

[[noreturn]] void refuse(const PlanarScene& scene, const std::string& what) {
  throw InputError("scene '" + scene.name + "': " + what);
}

void check_texture(const PlanarScene& scene) {
  if (!scene.albedo || scene.albedo->texels.empty()) refuse(scene, "has no texture");
  for (const Vec4f& t : scene.albedo->texels)
    for (int c = 0; c < 3; ++c)
      if (!(t[c] >= 0 && t[c] <= 1)) refuse(scene, "a texel's albedo lies outside [0, 1]");
  if (!(scene.tile.x > 0 && scene.tile.y > 0)) refuse(scene, "the texture's width must be positive");
}

}  // namespace

void check(const PlanarScene& scene) {
  check_texture(scene);
  const Medium& medium = scene.medium;
  if (!(medium.mean_free_path.min() > 0)) refuse(scene, "the mean free path must be positive");
  if (!(medium.g > -1 && medium.g < 1)) refuse(scene, "g must lie between -1 and 1");
  if (!(medium.eta >= 1)) refuse(scene, "eta must be at least 1");
  if (scene.light.shape != PlanarLight::Shape::plane && !(scene.light.radius > 0))
    refuse(scene, "the light's radius must be positive");
  const PlanarView& view = scene.view;
  if (view.width < 1 || view.height < 1 || !(view.size.x > 0 && view.size.y > 0))
    refuse(scene, "the view is empty; give it a positive size and resolution");
  if (!(view.towards.z > 0))
    refuse(scene, "the view looks from below the surface; its direction needs z > 0");
}

}  // namespace alabaster
