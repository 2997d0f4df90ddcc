#pragma once

#include "core/rgb.h"

namespace alabaster {

/// The homogeneous basis R(rho; alpha) of docs/optics.md for one (g, eta): of the light that crossed into a
/// half-space at a point and scattered at least once, the density per unit optical area that leaves at
/// optical distance rho. All distances are optical (unitless); scene units are made by the caller: S(d) =
/// sigma_t^2 R(sigma_t d). Immutable and thread-safe. Albedos are clamped to [0, 1].
class ProfileTable {
 public:
  virtual ~ProfileTable() = default;

  virtual double g() const = 0;
  virtual double eta() const = 0;

  /// A(alpha): the integral of R over the plane, in [0, 1]; A(0) = 0, A(1) = 1, increasing.
  virtual double reflectance(double albedo) const = 0;
  /// The inverse of reflectance(), A in [0, 1].
  virtual double albedo_from_reflectance(double reflectance) const = 0;

  /// R(rho; alpha) / alpha, finite as alpha -> 0 (single scattering alone). rho > 0; diverges as 1/rho.
  virtual double evaluate_over_albedo(double albedo, double rho) const = 0;
  double evaluate(double albedo, double rho) const { return albedo * evaluate_over_albedo(albedo, rho); }

  /// The same for three channels in one call: at one distance (grey extinction), or at one distance each.
  virtual Rgb evaluate_over_albedo(const Rgb& albedo, double rho) const {
    return {evaluate_over_albedo(albedo.r, rho), evaluate_over_albedo(albedo.g, rho),
            evaluate_over_albedo(albedo.b, rho)};
  }
  virtual Rgb evaluate_over_albedo(const Rgb& albedo, const Rgb& rho) const {
    return {evaluate_over_albedo(albedo.r, rho.r), evaluate_over_albedo(albedo.g, rho.g),
            evaluate_over_albedo(albedo.b, rho.b)};
  }

  /// Draws rho with density pdf(albedo, rho) per unit rho (not per area), u in [0, 1).
  virtual double sample(double albedo, double u) const = 0;
  /// 2 pi rho R(rho; alpha) / A(alpha), up to the fit: it is exactly the density that sample() draws from,
  /// positive for every rho > 0.
  virtual double pdf(double albedo, double rho) const = 0;
};

/// The table of the baseline, g = 0.3, eta = 1.5, compiled into the program.
const ProfileTable& baseline_profile();

}  // namespace alabaster
