#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "bssrdf/distance_table.h"
#include "bssrdf/kernel_placement.h"
#include "bssrdf/pair_shape.h"
#include "core/rgb.h"
#include "geometry/geodesic.h"
#include "geometry/surface_point.h"
#include "optics/profile_table.h"
#include "optics/shaped_profile.h"
#include "texture/albedo_field.h"

namespace alabaster {

/// A surface point with what every model asks of it, read once.
struct BssrdfPoint {
  SurfacePoint surface;
  Rgb albedo;
  PointShape shape{};  // filled for the shape basis only
  /// Of an exit: unit, outside, towards who sees the light; 0: averaged over directions. For composite:view,
  /// and for the choice of entries under light's aim.
  Vec3 towards_viewer{0};
};

/// What the shape basis reads: the families of its medium and the shape of the object's surface.
struct ShapeBasis {
  const ShapeFamilies* families = nullptr;
  const CurvatureField* surface = nullptr;
};

/// What light meets below one surface: the homogeneous basis in scene units and the albedo over the surface.
/// Without `shape` the basis is that of a half-space, without `distance` the d it is asked for is the chord.
struct BssrdfMedium {
  const ProfileTable* profile = nullptr;
  Rgb sigma_t;                          // 1/m
  const AlbedoField* albedo = nullptr;  // of the object
  const ShapeBasis* shape = nullptr;
  const Geodesic* distance = nullptr;  // the chord also where this finds no way

  BssrdfPoint point(const SurfacePoint& surface) const {
    return {surface, albedo->at(surface), shape_at(surface.triangle, surface.barycentric)};
  }
  /// Nothing without the shape basis.
  PointShape shape_at(uint32_t triangle, Vec2 barycentric) const {
    if (shape == nullptr) return {};
    return PointShape(shape->surface->at(triangle, barycentric), thickest_body / sigma_t.min());
  }
};

/// A spatially varying BSSRDF S_V(x_i, x_e). Exactly: evaluate, sample a distance, pdf of a distance.
/// Thread-safe.
class Bssrdf {
 public:
  explicit Bssrdf(const BssrdfMedium& medium);
  virtual ~Bssrdf() = default;

  /// S_V per channel, 1/m^2. Finite for distance > 0.
  virtual Rgb evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const = 0;

  /// The albedo a typical evaluation for this exit sees: what sampling should be aimed at. 0 in a channel
  /// only where S_V is 0 for every entry.
  virtual Rgb typical_albedo(const BssrdfPoint& exit) const { return exit.albedo; }
  /// Over what distance that hardly changes, m, so that one value may serve a whole small triangle; 0: it may
  /// change at once.
  virtual double typical_albedo_reach() const { return 0; }

  /// Draws a distance from the exit, m, for one channel, u in [0, 1).
  double sample_distance(const BssrdfPoint& exit, int channel, double u) const;
  /// Density of sample_distance per metre; positive for every distance > 0.
  double pdf_distance(const BssrdfPoint& exit, int channel, double distance) const;

  /// Distance and shape of a pair, for the basis.
  PairShape pair(const Vec3& entry, const PointShape& at_entry, const Vec3& exit,
                 const PointShape& at_exit) const {
    if (medium_.shape != nullptr) return pair_shape(entry, at_entry, exit, at_exit);
    PairShape flat;
    flat.distance = glm::distance(entry, exit);
    return flat;
  }
  /// Concentration of light's aim per channel, see ShapeFamilies::aim; 0 on the half-space basis. At the mean
  /// of the albedos at both ends.
  Rgb aim(const BssrdfPoint& entry, const BssrdfPoint& exit) const;
  /// S(alpha, d) / alpha in scene units, 1/m^2: sigma_t^2 R(sigma_t d; alpha) / alpha, times the factor of
  /// the shape.
  Rgb basis_over_albedo(const Rgb& albedo, const PairShape& pair) const {
    return shaped_ ? shaped_->over_albedo(albedo, pair) : half_space_over_albedo(albedo, pair.distance);
  }

  const BssrdfMedium& medium() const { return medium_; }
  const DistanceTable& distances() const { return distances_; }

 protected:
  PairShape pair(const BssrdfPoint& entry, const BssrdfPoint& exit) const {
    return pair(entry.surface.position, entry.shape, exit.surface.position, exit.shape);
  }
  /// The pair as the basis is to see it: with the medium's distance for its chord.
  void take_distance(PairShape& pair, const BssrdfPoint& entry, const BssrdfPoint& exit) const {
    if (medium_.distance != nullptr)
      pair.distance = medium_.distance->distance(entry.surface, exit.surface).value_or(pair.distance);
  }

  BssrdfMedium medium_;

 private:
  Rgb half_space_over_albedo(const Rgb& albedo, double distance) const;

  DistanceTable distances_;
  std::optional<ShapedProfile> shaped_;
};

/// What the models may be told; each reads what concerns it.
struct BssrdfOptions {
  const KernelPlacement* placement = nullptr;  // aggregate, composite: required; outlives the model
  double ellipse_width = 1;                    // aggregate: see aggregate.h
  int ellipse_samples = 0;  // aggregate: Monte Carlo with so many samples (at most 64); 0: pyramid taps
};

/// A model by name: homogeneous, factorized, aggregate, composite, or a variant: composite:symmetric
/// (reciprocal kernel), composite:order1 (order 1 apart), composite:view (alpha_e where the view's ray was
/// last scattered). Throws InputError for any other name.
std::unique_ptr<Bssrdf> make_bssrdf(std::string_view name, const BssrdfMedium& medium,
                                    const BssrdfOptions& options);

}  // namespace alabaster
