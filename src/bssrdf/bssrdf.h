#pragma once

#include "core/rgb.h"
#include "geometry/surface_point.h"
#include "optics/profile_table.h"
#include "texture/albedo_field.h"

namespace alabaster {

/// A surface point with what every model asks of it, read once.
struct BssrdfPoint {
  SurfacePoint surface;
  Rgb albedo;
};

/// What light meets below one surface: the homogeneous basis in scene units and the albedo over the surface.
struct BssrdfMedium {
  const ProfileTable* profile = nullptr;
  Rgb sigma_t;                          // 1/m
  const AlbedoField* albedo = nullptr;  // of the object

  BssrdfPoint point(const SurfacePoint& surface) const { return {surface, albedo->at(surface)}; }
};

/// A spatially varying BSSRDF S_V(x_i, x_e). Exactly: evaluate, sample a distance, pdf of a distance.
/// Thread-safe.
class Bssrdf {
 public:
  explicit Bssrdf(const BssrdfMedium& medium) : medium_(medium) {}
  virtual ~Bssrdf() = default;

  /// S_V per channel, 1/m^2. Finite for distance > 0.
  virtual Rgb evaluate(const BssrdfPoint& entry, const BssrdfPoint& exit) const = 0;

  /// Draws a distance from the exit, m, for one channel, u in [0, 1).
  virtual double sample_distance(const BssrdfPoint& exit, int channel, double u) const;
  /// Density of sample_distance per metre; positive for every distance > 0.
  virtual double pdf_distance(const BssrdfPoint& exit, int channel, double distance) const;

  const BssrdfMedium& medium() const { return medium_; }

 protected:
  BssrdfMedium medium_;
};

}  // namespace alabaster
