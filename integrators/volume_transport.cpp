#include "integrators/volume_transport.h"

#include <fmt/format.h>

#include <cmath>

#include "integrators/volume_checks.h"

namespace alabaster {

VolumeTransport::VolumeTransport(const Scene& scene, uint32_t object, const Medium& medium,
                                 const std::vector<uint8_t>& boundary, const VolumeWalkOptions& options,
                                 const LightGuide* guide)
    : name_(scene.objects[object].name),
      eta_(medium.eta),
      walk_(scene.rays, scene.objects[object].mesh, object, boundary, medium, *scene.objects[object].albedo,
            options, guide, scene.objects[object].density.get()) {
  if (!options.open_sheets) check_closed(scene, scene.objects[object]);
  check_one_medium(scene, scene.objects[object], boundary);
}

std::optional<SubsurfaceEntry> VolumeTransport::sample(const SurfacePoint& exit, const Vec3& viewer,
                                                       const Sampler& sampler, uint32_t occurrence) const {
  // Snell's law, backwards along the light; the exit's Fresnel factor is the caller's. The smooth normal
  // keeps facets out of the picture; within the walk the boundary is the geometry itself.
  const Vec3& normal = exit.shading_normal;
  const Vec3 along = (glm::dot(viewer, normal) * normal - viewer) / eta_;
  const Vec3 inwards = along - std::sqrt(std::max(0.0, 1 - glm::dot(along, along))) * normal;
  if (glm::dot(inwards, exit.geometric_normal) >= 0) return std::nullopt;
  Rng rng = sampler.stream(Dimension::walk, occurrence);
  const auto end = walk_.walk(exit, glm::normalize(inwards), rng);
  if (!end || end->order == 0) return std::nullopt;
  return SubsurfaceEntry{end->point, end->direction, std::nullopt, end->weight};
}

std::string VolumeTransport::report() const {
  const VolumeWalk::Counts& counts = walk_.counts();
  const auto walks = static_cast<double>(counts.walks.load());
  if (walks == 0) return {};
  const auto collisions = static_cast<double>(counts.collisions.load());
  std::string text =
      fmt::format("object '{}': {:.3g} million walks of {:.3g} collisions and {:.3g} rays", name_,
                  1e-6 * walks, collisions / walks, static_cast<double>(counts.rays.load()) / walks);
  if (const AlbedoCells* cells = walk_.cells())
    text += fmt::format(
        "; {:.3g} % of the albedos exact, the others from cells ({:.3g} million queries, {:.3g} MB) "
        "with an error of expectation 0",
        100 * static_cast<double>(counts.queries.load()) / std::max(1.0, collisions),
        1e-6 * static_cast<double>(cells->queries()), 1e-6 * static_cast<double>(cells->bytes()));
  if (const auto lost = counts.lost.load(); lost > 0) text += fmt::format("; {} walks lost", lost);
  return text;
}

}  // namespace alabaster
