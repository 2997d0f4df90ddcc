#pragma once

#include "integrators/subsurface_transport.h"
#include "integrators/volume_walk.h"
#include "scene/scene.h"

namespace alabaster {

/// Subsurface light by random walks through the volume: the reference, or with the exit's albedo everywhere
/// the walk of production renderers.
class VolumeTransport final : public SubsurfaceTransport {
 public:
  /// Throws InputError where the object is open (naming an edge of its border) or where not all of its
  /// surface bounds the medium. The scene and the guide (or null) outlive the transport.
  VolumeTransport(const Scene& scene, uint32_t object, const Medium& medium,
                  const std::vector<uint8_t>& boundary, const VolumeWalkOptions& options,
                  const LightGuide* guide);

  std::optional<SubsurfaceEntry> sample(const SurfacePoint& exit, const Vec3& viewer, const Sampler& sampler,
                                        uint32_t occurrence) const override;
  std::string report() const override;

  const VolumeWalk::Counts& counts() const { return walk_.counts(); }

 private:
  std::string name_;
  double eta_;
  VolumeWalk walk_;
};

}  // namespace alabaster
