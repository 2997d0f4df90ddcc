#include "optics/shaped_profile.h"

#include <cmath>

#include "core/vec.h"
#include "optics/row_position.h"
#include "optics/shape_lookup.h"
#include "optics/tabulated_profile.h"

namespace alabaster {

namespace {

// With a number for the last lane.
inline Double4 four(const Rgb& v, double last) {
  return Double4{v.r, v.g, v.b, last};
}

inline Float4 with_last(Float4 v, double last) {
  v[3] = shape_lookup::at_least(last);
  return v;
}

}  // namespace

ShapedProfile::ShapedProfile(const ProfileTable& half_space, const ShapeFamilies& families,
                             const Rgb& sigma_t)
    : half_space_(&half_space),
      tabulated_(dynamic_cast<const TabulatedProfile*>(&half_space)),
      families_(&families),
      paths_(sigma_t),
      sigma_t_(sigma_t),
      sigma_t_square_(sigma_t * sigma_t) {}

Rgb ShapedProfile::one_by_one(const Rgb& albedo, const PairShape& pair) const {
  const Rgb half_space = half_space_->evaluate_over_albedo(albedo, pair.distance * sigma_t_);
  return sigma_t_square_ * half_space * families_->factor(pair, albedo, paths_);
}

Rgb ShapedProfile::over_albedo(const Rgb& albedo, const PairShape& pair) const {
  if (tabulated_ == nullptr || ShapeFamilies::is_flat(pair, paths_)) return one_by_one(albedo, pair);
  const Double4 rho = pair.distance * four(sigma_t_, 1);
  const Double4 rest = 1 - four(albedo, 1), zero = rho - rho, one = zero + 1;
  const Double4 positive = rest > zero ? rest : zero;
  const Float4 remainder = to_float(positive < one ? positive : one);
  const Float4 root = square_root(remainder);
  // One logarithm for all.
  const Float8 logs = fast_log2(join(with_last(row_position_argument(root), std::abs(pair.curvature)),
                                     with_last(to_float(rho), pair.inverse_thickness)));
  const Float4 row = row_position(lower(logs), root), log2_rho = upper(logs);
  const shape_lookup::Query query{remainder, row,     log2_rho[0] + paths_.log2_path[0],
                                  logs[3],   logs[7], paths_.is_grey && albedo.is_grey()};
  const Float4 density = fast_exp2(
      tabulated_->log2_density(row, log2_rho) +
      shape_lookup::log2_factor(families_->table(), static_cast<float>(families_->g()), pair, paths_, query));
  const double scale = 1 / (2 * pi);
  return pair.reach *
         (sigma_t_square_ * Rgb(scale * double{density[0]} / rho[0], scale * double{density[1]} / rho[1],
                                scale * double{density[2]} / rho[2]));
}

}  // namespace alabaster
