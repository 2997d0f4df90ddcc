#include "integrators/bssrdf_transport.h"

#include "optics/fresnel.h"
#include "optics/profile_store.h"
#include "texture/material_map.h"

namespace alabaster {

namespace {

/// Glass never scatters: it is spared the simulation of a profile that would be multiplied by 0.
std::shared_ptr<const ProfileTable> profile_of(const SceneObject& body, const Medium& medium) {
  if (body.albedo && body.albedo->max().is_black()) return profile_for(ProfileRequest{});
  return profile_for(medium.g, medium.eta);
}

PlacementBody placement_body(const Scene& scene, uint32_t object) {
  const SceneObject& body = scene.objects[object];
  PlacementBody result{&body.mesh, &body.atlas, &scene.rays, object};
  if (body.albedo) result.by_position_from = body.albedo->by_position_from();
  return result;
}

}  // namespace

BssrdfTransport::BssrdfTransport(const Scene& scene, uint32_t object, const Medium& medium,
                                 std::vector<uint8_t> boundary, const std::string& model, Basis basis,
                                 const std::string& placement, const std::string& distance,
                                 const ExpectedLight* light)
    : profile_(profile_of(scene.objects[object], medium)),
      lobe_(1 / (pi * diffuse_transmittance(medium.eta))),
      placement_(make_placement(placement, placement_body(scene, object))),
      distance_(make_surface_distance(distance, placement_body(scene, object))) {
  const SceneObject& body = scene.objects[object];
  if (basis == Basis::shape) {
    families_ = shapes_for(profile_->g(), profile_->eta());
    CurvatureOptions options;
    options.coarse_radius = coarse_radius / medium.sigma_t().min();
    curvature_ = CurvatureField(body.mesh, scene.rays, object, options);
    shape_ = {families_.get(), &curvature_};
  }
  const BssrdfMedium below{profile_.get(), medium.sigma_t(), body.albedo.get(),
                           basis == Basis::shape ? &shape_ : nullptr, distance_.get()};
  model_ = make_bssrdf(model, below, {placement_.get()});
  // On one albedo all models are the homogeneous one, which looks nothing up.
  if (dynamic_cast<const ConstantAlbedo*>(body.albedo.get()) != nullptr)
    model_ = make_bssrdf("homogeneous", below, {});
  probe_ = std::make_unique<ProbeSampler>(
      *model_, ProbeTarget{&scene.rays, &body.mesh, object, std::move(boundary), light});
}

std::optional<SubsurfaceEntry> BssrdfTransport::sample(const SurfacePoint& exit, const Vec3& viewer,
                                                       const Sampler& sampler, uint32_t occurrence) const {
  probe_->fetch(exit.triangle);
  BssrdfPoint from = model_->medium().point(exit);
  from.towards_viewer = viewer;
  const auto entry = probe_->sample_entry(from, sampler, occurrence);
  if (!entry || entry->weight.is_black()) return std::nullopt;
  SubsurfaceEntry result{entry->point.surface, std::nullopt, std::nullopt, entry->weight * lobe_};
  const Rgb concentration = model_->aim(entry->point, from);
  if (!concentration.is_black())
    result.aim = LightAim(concentration, result.point.position, result.point.shading_normal, exit.position,
                          exit.shading_normal, viewer);
  return result;
}

}  // namespace alabaster
