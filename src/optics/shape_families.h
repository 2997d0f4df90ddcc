#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "core/rgb.h"
#include "optics/fast_math.h"
#include "optics/shape_table.h"

namespace alabaster {

/// What the families of shapes are told of a pair of points. Lengths in any unit; sigma_t converts.
struct PairShape {
  double distance = 0;           // chord
  double curvature = 0;          // of the ball (positive) or cavity (negative) that the pair lies on
  double inverse_thickness = 0;  // of the slab; 0: nothing behind
  double separation = 0;         // of its sides at the pair, where one point is on the far side
  double lateral = 0;            // distance along the slab, for its far side
  double sphericity = 0;         // [0, 1]: 0 a slab, 1 a ball
  double far = 0;                // [0, 1]: 0 both points on one side of the slab, 1 on opposite sides
  double reach = 1;              // [0, 1]: 0 where no medium is between the points, but a gap
  double bend = 0;               // root mean square of the principal curvatures at both points
};

/// The mean free paths of three channels, in the unit of the pairs, read once per medium.
struct FreePaths {
  Float4 path, log2_path;  // the last lane is 1 and its logarithm
  float longest;
  bool is_grey;

  explicit FreePaths(const Rgb& sigma_t);
};

/// Correction factors of curved and thin bodies over the half-space basis, by interpolation in a ShapeTable:
/// linear in log size (after a spline has halved its steps), log distance and the position of the albedo.
/// Exactly 1 where curvature and inverse thickness are below 1e-5 per mean free path, and on slabs thicker
/// than ten diffusion lengths; reached continuously. Immutable and thread-safe.
class ShapeFamilies {
 public:
  /// Of curvature and inverse thickness, per mean free path: what counts as flat.
  static constexpr double flat = 1e-5;

  explicit ShapeFamilies(const ShapeTable& table);

  double g() const { return g_; }
  double eta() const { return eta_; }
  /// S of the shape over S of the half-space, per channel. `sigma_t` in the inverse of the pair's unit.
  Rgb factor(const PairShape& pair, const Rgb& albedo, const Rgb& sigma_t) const {
    return factor(pair, albedo, FreePaths(sigma_t));
  }
  Rgb factor(const PairShape& pair, const Rgb& albedo, const FreePaths& paths) const;
  /// Whether factor() is the pair's reach in every channel, by curvature and thickness.
  static bool is_flat(const PairShape& pair, const FreePaths& paths) {
    return !(static_cast<float>(std::abs(pair.curvature)) * paths.longest > static_cast<float>(flat)) &&
           !(static_cast<float>(pair.inverse_thickness) * paths.longest > static_cast<float>(flat));
  }
  /// For shape_lookup.h.
  const float* table() const { return table_.data(); }
  const float* aim_table() const { return aim_.data(); }
  /// Concentration of light's aim (LightAim), of the half-space's slopes (bake_aim), setting in with
  /// curvature and thinness: 0 on a half-space, in full where they exceed 1/20 per mean free path.
  Rgb aim(const PairShape& pair, const Rgb& albedo, const Rgb& sigma_t) const {
    return aim(pair, albedo, FreePaths(sigma_t));
  }
  Rgb aim(const PairShape& pair, const Rgb& albedo, const FreePaths& paths) const;
  /// factor() in one channel for one family: `size` a radius or thickness and `distance` a chord (balls,
  /// cavities) or lateral distance (slabs), mean free paths.
  double factor(ShapeFamily family, double size, double distance, double albedo) const;

 private:
  double g_, eta_;
  std::vector<float> aim_;    // by AimGrid
  std::vector<float> table_;  // per family [size, flat first][node][row]
};

/// factor() and aim() in one channel, for those who ask for many pairs at one albedo: less work than for
/// three.
class ShapeChannel {
 public:
  ShapeChannel() = default;
  /// `families` outlives this.
  ShapeChannel(const ShapeFamilies& families, double albedo, double sigma_t);
  double factor(const PairShape& pair) const;
  double aim(const PairShape& pair) const;

 private:
  const ShapeFamilies* families_ = nullptr;
  float path_ = 1, log2_path_ = 0;
  float remainder_ = 0, row_fraction_ = 0;
  int32_t row_ = 0;
};

/// The table of the baseline, g = 0.3, eta = 1.5, compiled into the program.
const ShapeTable& baseline_shape_table();
const ShapeFamilies& baseline_shapes();

}  // namespace alabaster
