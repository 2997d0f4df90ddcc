#include "optics/shape_families.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "core/error.h"
#include "core/statistics.h"
#include "optics/bake.h"
#include "optics/half_space_walk.h"
#include "optics/light_aim.h"
#include "optics/photon_walk.h"
#include "optics/profile_fit.h"
#include "optics/profile_table.h"
#include "optics/shape_bake.h"
#include "optics/tabulated_profile.h"

using namespace alabaster;

namespace {

// Light that a body returns at one albedo by the basis: over the surface, in equal steps of log distance.
double returned(ShapeFamily family, double size, double albedo) {
  const double end = ShapeGrid::is_slab(family) ? 300 + 30 * size : 2 * size;
  const int steps = 4000;
  const double first = 1e-5, step = std::log(end / first) / steps;
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double d = first * std::exp((k + 0.5) * step);
    const double chord = family == ShapeFamily::slab_far ? std::hypot(d, size) : d;
    sum += 2 * pi * d * d * step * baseline_profile().evaluate(albedo, chord) *
           baseline_shapes().factor(family, size, d, albedo);
  }
  return sum;
}

// Energy within a range of distances by a tally.
Estimate between(const std::vector<Estimate>& energy, double from, double to) {
  Estimate sum;
  for (int bin = 0; bin < RadialBins::count; ++bin) {
    if (RadialBins::edge(bin) < from || RadialBins::edge(bin + 1) > to) continue;
    sum.value += energy[static_cast<std::size_t>(bin)].value;
    sum.standard_error = std::hypot(sum.standard_error, energy[static_cast<std::size_t>(bin)].standard_error);
  }
  return sum;
}

}  // namespace

TEST_CASE("balls and cavities return the light of independent simulations") {
  CHECK(returned(ShapeFamily::ball, 3, 0.5) == Approx(0.0743).epsilon(0.01));
  CHECK(returned(ShapeFamily::ball, 3, 0.8) == Approx(0.2684).epsilon(0.01));
  CHECK(returned(ShapeFamily::ball, 3, 0.95) == Approx(0.6483).epsilon(0.01));
  CHECK(returned(ShapeFamily::ball, 10, 0.5) == Approx(0.0355).epsilon(0.01));
  CHECK(returned(ShapeFamily::ball, 10, 0.8) == Approx(0.1339).epsilon(0.01));
  CHECK(returned(ShapeFamily::ball, 10, 0.95) == Approx(0.4009).epsilon(0.01));
  const double error = 3.3 * 0.0008;  // of those simulations; the table may be off by 1 %
  CHECK(returned(ShapeFamily::cavity, 10, 0.5) == Approx(0.0253).margin(error + 0.01 * 0.0253));
  CHECK(returned(ShapeFamily::cavity, 10, 0.8) == Approx(0.0846).margin(error + 0.01 * 0.0846));
  CHECK(returned(ShapeFamily::cavity, 10, 0.95) == Approx(0.2186).margin(error + 0.01 * 0.2186));
  CHECK(returned(ShapeFamily::cavity, 10, 0.99) == Approx(0.3862).margin(error + 0.01 * 0.3862));
}

TEST_CASE("between the sizes of the grid: totals within 1 %, profiles within 3 %, beyond statistics") {
  struct Row {
    ShapeFamily family;
    double size;
  };
  // Half way between grid sizes in the logarithm.
  for (const Row row :
       {Row{ShapeFamily::ball, 2.378}, Row{ShapeFamily::ball, 13.45}, Row{ShapeFamily::slab_near, 1.189},
        Row{ShapeFamily::slab_near, 6.727}, Row{ShapeFamily::cavity, 3.364}}) {
    BodyWalkOptions options;
    options.photons = row.family == ShapeFamily::cavity ? 100000 : 1000000;
    options.seed = 77;
    options.stages.last = row.family == ShapeFamily::cavity ? 4 : WalkStages::count - 1;
    const PathTally tally = body_tally(shape_body(row.family, row.size), options);
    for (const double albedo : {0.5, 0.9, 0.99}) {
      for (const bool far : {false, true}) {
        if (far && row.family != ShapeFamily::slab_near) continue;
        const ShapeFamily family = far ? ShapeFamily::slab_far : row.family;
        const std::vector<Estimate> energy =
            far ? far_radial_energy_over_albedo(tally, albedo) : radial_energy_over_albedo(tally, albedo);
        const double all = returned(family, row.size, albedo) / albedo;
        const Estimate total = between(energy, 0, HUGE_VAL);
        INFO(static_cast<int>(family) << " " << row.size << " at " << albedo << ": " << all << " against "
                                      << total.value << " +- " << total.standard_error);
        CHECK(std::abs(all - total.value) < 0.01 * total.value + 3.5 * total.standard_error);
        // An octave of distance at a time.
        for (int octave = -4; octave < 5; ++octave) {
          const double from = std::exp2(octave), to = 2 * from;
          if (!ShapeGrid::is_slab(family) && to > 2 * row.size) break;
          const Estimate part = between(energy, 0.9999 * from, 1.0001 * to);
          if (part.value < 0.01 * total.value) continue;
          double expected = 0;
          for (int k = 0; k < 64; ++k) {
            const double d = from * std::exp2((k + 0.5) / 64);
            const double chord = far ? std::hypot(d, row.size) : d;
            expected += 2 * pi * d * d * (0.69314718 / 64) *
                        baseline_profile().evaluate_over_albedo(albedo, chord) *
                        baseline_shapes().factor(family, row.size, d, albedo);
          }
          INFO("from " << from << ": " << expected << " against " << part.value << " +- "
                       << part.standard_error);
          CHECK(std::abs(expected - part.value) < 0.03 * part.value + 3.5 * part.standard_error);
        }
      }
    }
  }
}

TEST_CASE("other media, quickly baked: a small cavity and a ball return what other walks say, within 3 %") {
  BakeOptions bake;
  bake.medium = {0.8, 1.33};
  bake.photons = 1;  // a chunk: the factors hold what it lacks
  const TabulatedProfile half_space(tabulate(half_space_tally({bake.medium, bake.photons, 3, false}), bake));
  ShapeBakeOptions options;
  options.medium = bake.medium;
  options.photons = quick_shape_photons;
  const double limit = 3.9;  // 1e-3 over all
  for (const auto& [family, size] : {std::pair{ShapeFamily::cavity, 2.0}, {ShapeFamily::ball, 8.0}}) {
    const WalkBody body = shape_body(family, size);
    const PathTally tally = body_tally(body, shape_walk_options(family, size, options));
    BodyWalkOptions other{bake.medium, 3'000'000, 77, {}};
    other.stages.first_thinning = 3;
    other.stages.last = 3;
    const PathTally check = body_tally(body, other);
    std::vector<double> factors;
    for (int row = 0; row < ShapeGrid::rows; ++row) {
      const double albedo = ShapeGrid::albedo(row);
      factors =
          shape_factors(family, size, albedo, radial_energy_over_albedo(tally, albedo), half_space, factors);
      if (albedo < 0.4 || albedo > 0.99) continue;
      double all = 0;
      const double step = 0.69314718 / 16;
      for (double d = 2 * size * std::exp(-0.5 * step); d > 1e-4; d *= std::exp(-step)) {
        const double node =
            ShapeGrid::nodes(family) - 1 + ShapeGrid::nodes_per_octave * std::log2(d / (2 * size));
        const auto i = static_cast<std::size_t>(std::max(node, 0.0));
        const double t = std::max(node, 0.0) - static_cast<double>(i);
        all += 2 * pi * d * d * step * half_space.evaluate_over_albedo(albedo, d) *
               std::exp2((1 - t) * factors[i] + t * factors[i + 1]);
      }
      const Estimate total = check.reflectance_over_albedo(albedo);
      INFO(static_cast<int>(family) << " at " << albedo << ": " << all << " against " << total.value << " +- "
                                    << total.standard_error);
      CHECK(std::abs(all - total.value) < 0.03 * total.value + limit * total.standard_error);
    }
  }
}

TEST_CASE("flat is exactly 1, and reached continuously") {
  const ShapeFamilies& shapes = baseline_shapes();
  const auto factor = [&](const PairShape& pair, double albedo) {
    return shapes.factor(pair, Rgb(albedo), Rgb(1)).r;
  };
  for (const double albedo : {0.0, 0.5, 0.9, 0.999, 1.0})
    for (const double d : {1e-3, 0.1, 1.0, 10.0, 1000.0}) {
      for (const double curvature : {0.0, 1e-16, 0.99e-5, -0.99e-5})
        for (const double sphericity : {0.0, 0.5, 1.0})
          CHECK(factor({d, curvature, 0, 1, d, sphericity, 0}, albedo) == 1.0);
      // Nothing behind, and behind ten diffusion lengths.
      const double length = diffusion_length(albedo, shapes.g());
      if (std::isfinite(length))
        for (const double far : {0.0, 0.5, 1.0})
          CHECK(factor({d, 0, 1 / (10.01 * length), 10.01 * length, d, 0, far}, albedo) == 1.0);
      for (const double sign : {-1.0, 1.0})
        CHECK(factor({std::min(d, 1e3), sign * 1.01e-5, 0, 1, d, 1, 0}, albedo) == Approx(1).epsilon(0.01));
    }
  // Small steps of the arguments make small steps of the factor.
  for (const double albedo : {0.3, 0.95, 0.9999}) {
    double before[3] = {};
    for (int k = 0; k < 4000; ++k) {
      const double x = std::exp2(-18 + 20.0 * k / 4000);  // curvature or inverse thickness
      const double d = 0.7;
      const double now[3] = {std::log(factor({d, x, 0, 1, d, 1, 0}, albedo)),
                             std::log(factor({d, -x, 0, 1, d, 1, 0}, albedo)),
                             std::log(factor({d, 0, x, 1 / x, d, 0, 0.3}, albedo))};
      for (int i = 0; i < 3; ++i) {
        if (k > 0) CHECK(std::abs(now[i] - before[i]) < 0.06);
        before[i] = now[i];
      }
    }
  }
}

TEST_CASE("light's aim: 0 on a half-space, the table's on bodies, reached continuously") {
  const ShapeFamilies& shapes = baseline_shapes();
  const auto aim = [&](double distance, double bend, double inverse_thickness, double albedo) {
    PairShape pair;
    pair.distance = distance;
    pair.bend = bend;
    pair.inverse_thickness = inverse_thickness;
    return shapes.aim(pair, Rgb(albedo), Rgb(1)).r;
  };
  for (const double albedo : {0.0, 0.5, 0.9, 0.999, 1.0})
    for (const double d : {1e-3, 0.1, 1.0, 10.0, 1000.0}) {
      CHECK(aim(d, 0, 0, albedo) == 0);
      CHECK(aim(d, 1e-5, 0, albedo) == 0);
      if (albedo < 1) CHECK(aim(d, 0, 1 / (10.01 * diffusion_length(albedo, shapes.g())), albedo) == 0);
      double before = 0;
      for (int k = 0; k <= 600; ++k) {
        const double now = aim(d, 1e-4 * k, 0, albedo);
        CHECK(std::abs(now - before) < 0.03);
        before = now;
      }
    }
  // Independent walks: the mean of w . u where light leaves, over that of its square, two octaves.
  const AimSlopes slopes(1.5);
  Rng rng(71);
  for (const double albedo : {0.9, 0.98})
    for (const double from : {1.0, 4.0}) {
      RunningMoments slope;
      double expected = 0, light = 0;
      for (int k = 0; k < 40000; ++k) {
        Photon photon;
        photon.direction = sample_diffuse_entry(1.5, rng);
        const WalkEnd end =
            walk(HalfSpace(), WalkMedium{}, photon, rng, [](const Photon& p, Rng&) { return p.order < 300; });
        const double rho = std::hypot(photon.position.x, photon.position.y);
        const bool counts = end == WalkEnd::left && photon.order > 0 && rho > from && rho < 2 * from;
        const double weight = counts ? std::pow(albedo, static_cast<double>(photon.order)) : 0;
        const double b = slopes.slope(aim(rho, 1, 0, albedo));
        const Vec3 u = photon.position / std::max(rho, 1e-9);
        const double along = 1.5 * (photon.direction.x * u.x + photon.direction.y * u.y);
        // 0.2392: the mean of (w . u)^2 over the Fresnel-weighted cosine.
        slope.add(weight * (along - 0.2392 * b));
        expected += weight * 0.2392 * b;
        light += weight;
      }
      INFO(albedo << " from " << from << ": " << slope.mean() << " +- " << slope.standard_error());
      CHECK(expected > 0.05 * light);
      CHECK(std::abs(slope.mean()) < 3.5 * slope.standard_error() + 0.03 * expected / 40000);
    }
}

TEST_CASE("where nothing can be measured the factors stay moderate") {
  // Far beyond the diffusion length, at low albedo, only the neighbours in albedo tell.
  for (const std::vector<int16_t>& family : baseline_shape_table().log2_factor) {
    const auto [least, most] = std::minmax_element(family.begin(), family.end());
    CHECK(*least * ShapeTable::step > -21);
    // Across a ball of 8, light that scattered once goes 16 mean free paths, in a half-space much farther: by
    // the walks 2^25.
    CHECK(*most * ShapeTable::step < 26);
  }
}

TEST_CASE("three channels at once are the channels one by one") {
  const ShapeFamilies& shapes = baseline_shapes();
  const Rgb albedo(0.3, 0.9, 0.999), sigma_t(500, 1000, 2500);
  const PairShape pair{0.003, 120, 200, 0.005, 0.002, 0.4, 0.25};
  const Rgb all = shapes.factor(pair, albedo, sigma_t);
  for (int c = 0; c < 3; ++c)
    CHECK(all[c] == Approx(shapes.factor(pair, Rgb(albedo[c]), Rgb(sigma_t[c])).r).epsilon(1e-6));
  // A pure ball is the ball's family.
  const PairShape ball{0.003, 120, 200, 0.005, 0.002, 1, 0.25};
  CHECK(shapes.factor(ball, albedo, sigma_t)[1] ==
        Approx(shapes.factor(ShapeFamily::ball, 1000 / 120.0, 3, 0.9)).epsilon(1e-5));
}

TEST_CASE("a ball, a cavity and a slab of the committed table come back bit for bit from their walks",
          "[slow]") {
  const ShapeTable& table = baseline_shape_table();
  ShapeBakeOptions options;
  options.photons = full_shape_photons;
  options.seed = table.seed;
  for (const auto& [family, size] :
       {std::pair{ShapeFamily::ball, 7}, {ShapeFamily::cavity, 9}, {ShapeFamily::slab_near, 5}}) {
    const double radius = ShapeGrid::size(size);
    const PathTally tally =
        body_tally(shape_body(family, radius), shape_walk_options(family, radius, options));
    std::vector<double> factors;
    int different = 0;
    for (int row = 0; row < ShapeGrid::rows; ++row) {
      const double albedo = ShapeGrid::albedo(row);
      factors = shape_factors(family, radius, albedo, radial_energy_over_albedo(tally, albedo),
                              baseline_profile(), factors);
      for (int node = 0; node < ShapeGrid::nodes(family); ++node) {
        const int16_t stored =
            table.log2_factor[static_cast<std::size_t>(family)][ShapeTable::index(family, size, node, row)];
        different += std::lround(factors[static_cast<std::size_t>(node)] / ShapeTable::step) != stored;
      }
    }
    CHECK(different == 0);
  }
}

TEST_CASE("tables of shapes survive writing and reading, and broken ones are refused") {
  const ShapeTable& table = baseline_shape_table();
  std::string bytes = encode_shape_table(table);
  CHECK(bytes.size() < 2'000'000);
  CHECK(decode_shape_table(bytes, "here").log2_factor == table.log2_factor);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] + 1);
  CHECK_THROWS_WITH(decode_shape_table(bytes, "here"), Catch::Contains("checksum"));
  CHECK_THROWS_AS(decode_shape_table(std::string("ALABSHAP"), "here"), InputError);
  CHECK_THROWS_AS(decode_shape_table(std::string("nothing"), "here"), InputError);
}
