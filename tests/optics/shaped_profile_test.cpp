#include "optics/shaped_profile.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "optics/profile_fit.h"
#include "optics/profile_store.h"

using namespace alabaster;

namespace {

double lerp(double a, double b, double t) {
  return a + t * (b - a);
}

// Place in a table: the lower of two neighbours, and the fraction between them.
struct Between {
  int lower;
  double fraction;

  Between(double position, int count)
      : lower(std::clamp(static_cast<int>(position), 0, count - 2)),
        fraction(std::clamp(position, 0.0, count - 1.0) - lower) {}
};

// log2 of a family's factor straight from the table, in double precision and with the C library's functions.
double tabulated(ShapeFamily family, double inverse, double ratio, double albedo) {
  if (inverse <= ShapeFamilies::flat) return 0;
  const Between row(AlbedoRows::position(albedo) / ShapeGrid::row_stride, ShapeGrid::rows);
  const Between node(ShapeGrid::nodes_per_octave * (std::log2(ratio) - ShapeGrid::first_octave(family)),
                     ShapeGrid::nodes(family));
  const auto at_size = [&](int size) {
    size = std::clamp(size, 0, ShapeGrid::sizes - 1);
    const auto value = [&](int n, int r) {
      return ShapeTable::step * baseline_shape_table().log2_factor[static_cast<std::size_t>(
                                    family)][ShapeTable::index(family, size, node.lower + n, row.lower + r)];
    };
    return lerp(lerp(value(0, 0), value(0, 1), row.fraction), lerp(value(1, 0), value(1, 1), row.fraction),
                node.fraction);
  };
  const int last = ShapeGrid::sizes - 1;
  const double largest = ShapeGrid::size(last);
  if (inverse < 1 / largest)
    return lerp(0, at_size(last), (inverse - ShapeFamilies::flat) / (1 / largest - ShapeFamilies::flat));
  // Linear between the sizes and Catmull-Rom's midpoints.
  const Between half(4 * std::log2(largest * inverse), 2 * last + 1);
  const auto fine = [&](int k) {
    const int size = last - k / 2;
    if (k % 2 == 0) return at_size(size);
    return 0.5625 * (at_size(size) + at_size(size - 1)) - 0.0625 * (at_size(size + 1) + at_size(size - 2));
  };
  return lerp(fine(half.lower), fine(half.lower + 1), half.fraction);
}

double log2_factor(const PairShape& pair, double albedo, double sigma_t) {
  const double curved = std::abs(pair.curvature) / sigma_t, thin = pair.inverse_thickness / sigma_t;
  const double ball = tabulated(pair.curvature > 0 ? ShapeFamily::ball : ShapeFamily::cavity, curved,
                                0.5 * pair.distance * std::abs(pair.curvature), albedo);
  const double near = tabulated(ShapeFamily::slab_near, thin, pair.distance * pair.inverse_thickness, albedo);
  const double across = tabulated(ShapeFamily::slab_far, 1 / (pair.separation * sigma_t),
                                  pair.lateral / pair.separation, albedo);
  const double diffusion_lengths = 1 / (thin * diffusion_length(albedo, baseline_shapes().g()));
  const double x = std::clamp((100 - diffusion_lengths * diffusion_lengths) / 36, 0.0, 1.0);
  const double fade = thin > ShapeFamilies::flat ? x * x * (3 - 2 * x) : 0;
  const double s = pair.sphericity, far = pair.far;
  return (1 - far) * (ball + (1 - s) * fade * near) + far * (s * ball + (1 - s) * fade * across);
}

PairShape random_pair(Rng& rng) {
  const auto size = [&] { return std::exp2(-12 + 15 * rng.uniform()); };
  PairShape pair;
  pair.distance = std::exp2(-8 + 14 * rng.uniform());
  pair.curvature = rng.uniform() < 0.1 ? 0 : (rng.uniform() < 0.5 ? -1 : 1) * size();
  pair.inverse_thickness = rng.uniform() < 0.1 ? 0 : size();
  pair.separation = pair.inverse_thickness > 0 ? (0.5 + 1.5 * rng.uniform()) / pair.inverse_thickness : 1;
  pair.lateral = pair.distance * rng.uniform();
  pair.sphericity = std::clamp(1.5 * rng.uniform() - 0.25, 0.0, 1.0);
  pair.far = std::clamp(1.5 * rng.uniform() - 0.25, 0.0, 1.0);
  if (pair.inverse_thickness == 0) pair.far = 0;
  return pair;
}

Rgb random_albedo(Rng& rng) {
  const auto one = [&] { return 1 - std::pow(rng.uniform(), 3.0); };
  const double r = one();
  return rng.uniform() < 0.3 ? Rgb(r) : Rgb(r, one(), rng.uniform() < 0.1 ? 1 : one());
}

}  // namespace

TEST_CASE("factors of shapes are the table's, linear between its places") {
  Rng rng(11);
  double worst = 0;
  for (int k = 0; k < 20000; ++k) {
    const PairShape pair = random_pair(rng);
    const Rgb albedo = random_albedo(rng);
    const Rgb sigma_t = rng.uniform() < 0.5 ? Rgb(1.3) : Rgb(0.4, 1, 2.1);
    const Rgb factor = baseline_shapes().factor(pair, albedo, sigma_t);
    for (int c = 0; c < 3; ++c) {
      const double exact = log2_factor(pair, albedo[c], sigma_t[c]);
      worst = std::max(worst, std::abs(std::log2(factor[c]) - exact) / std::max(1.0, std::abs(exact)));
    }
  }
  INFO(worst);
  CHECK(worst < 2e-5);
}

TEST_CASE("the basis with its shape is the half-space's times the factor, bit for bit where that is 1") {
  Rng rng(12);
  const ShapeFamilies& shapes = baseline_shapes();
  const auto mixture = profile_for(ProfileRequest{0.3, 1.5, TableView::all, ProfileForm::mixture});
  for (const ProfileTable* half_space : {&baseline_profile(), mixture.get()})
    for (const Rgb& sigma_t : {Rgb(1.7), Rgb(0.4, 1, 2.1)}) {
      const ShapedProfile shaped(*half_space, shapes, sigma_t);
      const auto plain = [&](const Rgb& albedo, double distance) {
        return sigma_t * sigma_t * half_space->evaluate_over_albedo(albedo, distance * sigma_t);
      };
      for (int k = 0; k < 5000; ++k) {
        const Rgb albedo = random_albedo(rng);
        PairShape pair = random_pair(rng);
        const Rgb both = shaped.over_albedo(albedo, pair);
        const Rgb product = plain(albedo, pair.distance) * shapes.factor(pair, albedo, sigma_t);
        for (int c = 0; c < 3; ++c)  // fast_exp2 ends at 2^-126
          CHECK(both[c] == Approx(product[c]).epsilon(2e-5).margin(1e-30));

        pair.curvature = 0.9 * ShapeFamilies::flat * sigma_t.min() * rng.uniform();
        const double longest = diffusion_length(albedo.max(), shapes.g()) / sigma_t.min();
        if (!std::isfinite(longest)) continue;
        pair.inverse_thickness = rng.uniform() / (10.01 * longest);
        CHECK(shaped.over_albedo(albedo, pair) == plain(albedo, pair.distance));
        pair.reach = 0.25;
        CHECK(shaped.over_albedo(albedo, pair) == 0.25 * plain(albedo, pair.distance));
      }
    }
}

TEST_CASE("one channel of a shape's factor and of light's aim is what all channels at once are") {
  Rng rng(13);
  for (int k = 0; k < 20000; ++k) {
    PairShape pair = random_pair(rng);
    pair.reach = rng.uniform();
    pair.bend = 0.2 * rng.uniform();
    const double albedo = random_albedo(rng).r, sigma_t = std::exp2(2 * rng.uniform() - 1);
    const ShapeChannel channel(baseline_shapes(), albedo, sigma_t);
    const Rgb factor = baseline_shapes().factor(pair, Rgb(albedo), Rgb(sigma_t));
    CHECK(channel.factor(pair) == Approx(factor.r).epsilon(2e-5));
    CHECK(channel.aim(pair) ==
          Approx(baseline_shapes().aim(pair, Rgb(albedo), Rgb(sigma_t)).r).epsilon(1e-4).margin(1e-5));
    pair.inverse_thickness = pair.separation = pair.lateral = 0;
    CHECK(channel.factor(pair) ==
          Approx(baseline_shapes().factor(pair, Rgb(albedo), Rgb(sigma_t)).r).epsilon(2e-5));
    pair.curvature = pair.inverse_thickness = pair.bend = 0.9 * ShapeFamilies::flat * sigma_t / 1.5;
    CHECK(channel.factor(pair) == pair.reach);
    CHECK(channel.aim(pair) == 0);
  }
}
