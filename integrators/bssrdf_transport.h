#pragma once

#include <memory>
#include <string>

#include "bssrdf/basis.h"
#include "bssrdf/bssrdf.h"
#include "bssrdf/placements.h"
#include "bssrdf/probe_sampler.h"
#include "bssrdf/surface_distance.h"
#include "geometry/curvature.h"
#include "integrators/subsurface_transport.h"
#include "scene/scene.h"

namespace alabaster {

/// Subsurface light by a BSSRDF: an entry found by probe rays, S_V between it and the exit.
class BssrdfTransport final : public SubsurfaceTransport {
 public:
  /// `boundary` has one flag per material index: whether the medium lies below its triangles. Throws
  /// InputError for a model that make_bssrdf(), a placement that make_placement() or a distance that
  /// make_surface_distance() does not know. Scene and light, which may be null, outlive the transport.
  BssrdfTransport(const Scene& scene, uint32_t object, const Medium& medium, std::vector<uint8_t> boundary,
                  const std::string& model, Basis basis = Basis::half_space,
                  const std::string& placement = std::string(default_placement),
                  const std::string& distance = std::string(default_distance),
                  const ExpectedLight* light = nullptr);

  std::optional<SubsurfaceEntry> sample(const SurfacePoint& exit, const Vec3& viewer, const Sampler& sampler,
                                        uint32_t occurrence) const override;

  const Bssrdf& model() const { return *model_; }

 private:
  std::shared_ptr<const ProfileTable> profile_;
  std::shared_ptr<const ShapeFamilies> families_;  // of the shape basis
  CurvatureField curvature_;
  ShapeBasis shape_;
  double lobe_;  // 1 / (pi c): what leaves is spread as T(cos_o) / (pi c)
  std::unique_ptr<KernelPlacement> placement_;
  std::unique_ptr<const Geodesic> distance_;  // null: the chord
  std::unique_ptr<Bssrdf> model_;
  std::unique_ptr<ProbeSampler> probe_;
};

}  // namespace alabaster
