#include "bssrdf/surface_distance.h"

#include <algorithm>
#include <string>

#include "core/error.h"

namespace alabaster {

namespace {

/// The straightest path with the half-edges it walks over.
class StraightestDistance final : public Geodesic {
 public:
  explicit StraightestDistance(const TriangleMesh& mesh)
      : half_edges_(mesh), path_(make_straightest_path(mesh, half_edges_)) {}
  std::string_view name() const override { return path_->name(); }
  std::optional<double> distance(const SurfacePoint& from, const SurfacePoint& to) const override {
    return path_->distance(from, to);
  }

 private:
  HalfEdgeMesh half_edges_;
  std::unique_ptr<GeodesicPath> path_;
};

}  // namespace

const std::vector<std::string>& distance_names() {
  static const std::vector<std::string> names{"chord", "normal-corrected", "geodesic"};
  return names;
}

std::unique_ptr<const Geodesic> make_surface_distance(std::string_view name, const PlacementBody& body) {
  if (name == "chord") return nullptr;
  if (name == "normal-corrected") return make_normal_corrected_chord(*body.mesh, *body.rays, body.object);
  if (name == "geodesic") return std::make_unique<StraightestDistance>(*body.mesh);
  throw InputError("distance '" + std::string(name) +
                   "' is not known; use chord, normal-corrected or geodesic");
}

}  // namespace alabaster
