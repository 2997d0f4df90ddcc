#include "integrators/light_guide.h"

#include "scene/scene.h"

namespace alabaster {

LightGuide::LightGuide(const Scene& scene, const LightSampler& lights) : lights_(lights) {
  const double typical = lights.typical_radiance(scene.bounds.centre());
  unseen_ = typical > 0 ? 0.1 * typical : 1;
}

std::optional<LightGuide::Draw> LightGuide::sample(const Vec3& p, const Vec3& normal, Rng& rng) const {
  const double choice = rng.uniform();
  const Vec2 u(rng.uniform(), rng.uniform());
  const auto light = lights_.sample_concentrated(p, normal, choice, u);
  if (!light || glm::dot(light->direction, normal) <= 0) return std::nullopt;
  return Draw{light->direction, light->pdf, brightness(p, light->direction)};
}

double LightGuide::pdf(const Vec3& p, const Vec3& normal, const Vec3& direction) const {
  return glm::dot(direction, normal) > 0 ? lights_.pdf_concentrated(p, normal, direction) : 0;
}

double LightGuide::brightness(const Vec3& p, const Vec3& direction) const {
  return lights_.radiance_along(p, direction).mean() + lights_.uniform_radiance(p).mean() + unseen_;
}

}  // namespace alabaster
