#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "core/vec.h"

namespace alabaster {

/// Steers random walks towards the surface. Far below a plane surface the importance of a photon, what it
/// will contribute on average, is exp(-kappa depth) phi(mu), mu the cosine between its direction and the
/// outward normal: the discrete eigenfunction of the transport equation (Case & Zweifel 1967, "Linear
/// Transport Theory", section 4.2). A walk whose directions are drawn in proportion to phase function x phi
/// and whose flights have the rate 1 - kappa mu would carry a weight that does not fluctuate (Dwivedi 1982;
/// in rendering Krivanek & d'Eon 2014, Meng et al. 2016).
///
/// phi is cut off after a few Legendre terms, so that its mean over a Henyey-Greenstein lobe is known in
/// closed form. Whatever kappa and phi are, walks that divide by their densities stay unbiased. Immutable.
class DepthGuide {
 public:
  /// Of a medium with that mean cosine; kappa per mean free path, in [0, largest_kappa].
  DepthGuide(double g, double kappa);
  static constexpr double largest_kappa = 0.8;

  /// The decay of the importance with depth, per mean free path; at most largest_kappa. 0 at albedo 1.
  static double kappa_of(double g, double albedo);

  double kappa() const { return kappa_; }
  double phi(double mu) const { return polynomial(phi_, mu); }
  /// The mean of phi over the lobe of the phase function around a direction of that cosine.
  double mean_phi(double mu) const { return polynomial(mean_phi_, mu); }
  /// A direction after a collision, unit, of density phase function x phi(mu') / mean_phi(mu); mu and mu' are
  /// the cosines to `normal` before and after.
  Vec3 scatter(const Vec3& direction, const Vec3& normal, Rng& rng) const;

 private:
  static constexpr std::size_t terms = 6;
  using Coefficients = std::array<double, terms>;  // of the powers of mu
  static double polynomial(const Coefficients& c, double x) {
    double sum = c[terms - 1];
    for (std::size_t i = terms - 1; i-- > 0;) sum = sum * x + c[i];
    return sum;
  }

  double g_, kappa_;
  Coefficients phi_{}, mean_phi_{};
  double largest_phi_ = 1;
};

/// One flight of a steered walk. Most flights are drawn by the guide, the others plainly, and the weight
/// divides by the density of both together (one-sample balance heuristic), which bounds it.
struct SteeredFlight {
  static constexpr double share = 0.75;  // of flights that the guide draws
  bool steered = false;
  double turn = 1;     // the guide's density of the direction over the phase function's
  double stretch = 1;  // the guide's rate of collisions along it over sigma_t
  /// The density of both techniques over the plain one's, for a flight of that optical length that ends in a
  /// collision or at the boundary.
  double density(double optical_length, bool collides) const {
    const double gain = std::exp((1 - stretch) * optical_length);
    return (1 - share) + share * turn * (collides ? stretch : 1) * gain;
  }
};

/// The guides of one body, for every albedo and depth.
///
/// The smaller a body, the less depth decides. In a ball importance grows from the centre as sinh(kappa r) /
/// r, the logarithm of which has the slope kappa coth(kappa r) - 1 / r: that is what stands for kappa here, r
/// being what the depth leaves of the radius of the ball that has the body's ratio of volume to surface.
class DepthGuides {
 public:
  /// `radius` in mean free paths, of that ball; infinity for a half-space.
  DepthGuides(double g, double radius);
  /// What an albedo counts for the choice, 0 to 1; about one minus the reflectance, so that means of it over
  /// places and channels stand for the albedo that all of them act like.
  static double darkness(double albedo) { return std::sqrt(std::max(0.0, 1 - albedo)); }

  struct Choice {
    const DepthGuide* guide = nullptr;  // null where plain walks do as well
    double importance = 1;              // of light at that depth, over that at the surface
  };
  /// Guides for one darkness over depth.
  class Column {
   public:
    /// `depth` in mean free paths.
    const Choice& at(double depth) const {
      return choices_[static_cast<std::size_t>(std::min(depth * per_depth_, last_depth))];
    }

    /// About what a walk that comes back carries.
    double typical_weight() const { return typical_weight_; }

   private:
    friend class DepthGuides;
    static constexpr double last_depth = 63;
    std::array<Choice, 64> choices_;
    double per_depth_ = 0, typical_weight_ = 1;
  };
  const Column& column(double darkness) const;

 private:
  std::vector<DepthGuide> guides_;  // kappa in equal steps
  std::vector<Column> columns_;     // darkness in equal steps
};

}  // namespace alabaster
