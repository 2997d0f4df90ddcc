#include <catch2/catch.hpp>
#include <cstdio>

#include "core/parallel.h"
#include "optics/bake.h"
#include "optics/shape_bake.h"
#include "optics/shape_families.h"
#include "optics/tabulated_profile.h"

using namespace alabaster;

// The table of docs/shape_basis.md: what bodies of other media return by quickly baked families, against
// walks of another seed.

namespace {

constexpr double albedos[] = {0.5, 0.9, 0.99};

// Light over the albedo, over the surface in equal steps of log distance.
double returned(const ShapeFamilies& shapes, const ProfileTable& half_space, ShapeFamily family, double size,
                double albedo) {
  const double end = ShapeGrid::is_slab(family) ? 300 + 30 * size : 2 * size, first = 1e-5;
  const int steps = 4000;
  const double step = std::log(end / first) / steps;
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double d = first * std::exp((k + 0.5) * step);
    const double chord = family == ShapeFamily::slab_far ? std::hypot(d, size) : d;
    sum += 2 * pi * d * d * step * half_space.evaluate_over_albedo(albedo, chord) *
           shapes.factor(family, size, d, albedo);
  }
  return sum;
}

PathTally other_walks(const WalkMedium& medium, ShapeFamily family, double size) {
  BodyWalkOptions options{medium, 6'000'000, 77, {}};
  options.stages.first_thinning = 3;
  options.stages.last = 3;  // 0.99^1000 is nothing
  if (family == ShapeFamily::cavity) options.stages.quartered_from = 1;
  return body_tally(shape_body(family, size), options);
}

}  // namespace

TEST_CASE("totals of bodies of other media, baked quickly", "[.][bench]") {
  std::printf(
      "g, eta | worst error in per cent (standard error of the walks) at albedo 0.5, 0.9, 0.99 of "
      "balls | cavities | slabs | CPU seconds of the bake\n");
  for (const WalkMedium medium : {WalkMedium{0, 1}, WalkMedium{0.3, 1.5}, WalkMedium{0.8, 1.33},
                                  WalkMedium{0.9, 1}, WalkMedium{0.9, 1.5}}) {
    BakeOptions bake;
    bake.medium = medium;
    bake.photons = quick_photons;
    const TabulatedProfile half_space(bake_table(bake));
    ShapeBakeOptions options;
    options.medium = medium;
    options.photons = quick_shape_photons;
    const double start = cpu_seconds();
    const ShapeFamilies shapes(bake_shapes(options, half_space));
    const double seconds = cpu_seconds() - start;
    std::printf("| %g, %g |", medium.g, medium.eta);
    for (const ShapeFamily family : {ShapeFamily::ball, ShapeFamily::cavity, ShapeFamily::slab_near}) {
      double worst[3]{}, error[3]{};
      for (const double size : {1.0, 2.5, 10.0, 20.0}) {
        const PathTally tally = other_walks(medium, family, size);
        for (int a = 0; a < 3; ++a) {
          const Estimate e = tally.reflectance_over_albedo(albedos[a]);  // of both sides of a slab
          double all = returned(shapes, half_space, family, size, albedos[a]);
          if (family == ShapeFamily::slab_near)
            all += returned(shapes, half_space, ShapeFamily::slab_far, size, albedos[a]);
          const double off = 100 * (all / e.value - 1);
          if (std::abs(off) < std::abs(worst[a])) continue;
          worst[a] = off;
          error[a] = 100 * e.standard_error / e.value;
        }
      }
      for (int a = 0; a < 3; ++a) std::printf(" %+.1f (%.1f)%s", worst[a], error[a], a < 2 ? "," : " |");
    }
    std::printf(" %.0f |\n", seconds);
  }
}
