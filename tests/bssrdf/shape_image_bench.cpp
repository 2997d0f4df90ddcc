#include <catch2/catch.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "bssrdf/body_view.h"
#include "optics/half_space_walk.h"

using namespace alabaster;

// Where the errors of images of one albedo come from: bodies by equations, seen by a far camera, lit
// uniformly or by the sky of the study scenes, light that scattered at least once. docs/shape_basis.md.

namespace {

enum Quantity {
  exact,          // radiance
  exact_once,     // its first order
  exact_twice,    // its first two
  exit_averaged,  // Fresnel-weighted cosine at the exit
  entry_averaged,
  averaged,        // at both ends: what a basis S can know
  averaged_once,   // its first order
  averaged_twice,  // its first two
  plane_lobes,     // both ends averaged, the half-space's lobes at them
  body_lobes,      // the body's
  basis,
  basis_aimed,
  quantities
};

struct Pixel {
  double value[4][2][quantities]{}, variance[4][2][quantities]{};
};

void print(const BodyView& view, const WalkBody& family, int photons) {
  const Sky sky{0.15, 3, view.key};
  const SkyDirections directions(sky);
  const PathTally plane = half_space_tally({WalkMedium{}, 1000000, 3, false});
  const PathTally body = body_tally(family, {WalkMedium{}, 1000000, 3, 5});
  std::vector<Lobe> plane_lobe, body_lobe;
  std::vector<Entering> flat_sky, plane_sky, body_sky;
  for (const double albedo : body_albedos) {
    plane_lobe.push_back(Lobe::of(plane, albedo));
    body_lobe.push_back(Lobe::of(body, albedo));
    flat_sky.emplace_back(sky, Lobe());
    plane_sky.emplace_back(sky, plane_lobe.back());
    body_sky.emplace_back(sky, body_lobe.back());
  }
  std::vector<Pixel> pixels(view.exits.size());
  parallel_for(pixels.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Pixel& pixel = pixels[i];
      const Vec3 xe = view.exits[i], n = view.body.normal(xe);
      const double mu = glm::dot(n, view.camera);
      const auto add = [&](std::size_t a, int light, Quantity q, double v) {
        pixel.value[a][light][q] += v;
        pixel.variance[a][light][q] += v * v;
      };
      const auto orders = [&](bool diffuse) {
        walk_pixel(view, xe, diffuse, photons, i, [&](int64_t order, const Vec3& normal, const Vec3& w) {
          const double key = glm::dot(normal, view.key);
          for (std::size_t a = 0; a < body_albedos.size(); ++a) {
            const double weight = std::pow(body_albedos[a], static_cast<double>(order));
            for (int light = 0; light < 2; ++light) {
              const double along = light ? weight * sky.radiance(w) : weight;
              const double mean = light ? weight * flat_sky[a].at(key) : weight;
              if (!diffuse) {
                add(a, light, exact, along);
                if (order == 1) add(a, light, exact_once, along);
                if (order <= 2) add(a, light, exact_twice, along);
              } else {
                add(a, light, exit_averaged, along);
                add(a, light, averaged, mean);
                if (order == 1) add(a, light, averaged_once, mean);
                if (order <= 2) add(a, light, averaged_twice, mean);
                const double p = light ? weight * plane_sky[a].at(key) : weight;
                const double b = light ? weight * body_sky[a].at(key) : weight;
                add(a, light, plane_lobes, p * plane_lobe[a].at(mu));
                add(a, light, body_lobes, b * body_lobe[a].at(mu));
              }
            }
          }
        });
      };
      orders(false);
      orders(true);
      walk_pixel(view, xe, false, photons, i + 10000, [&](int64_t order, const Vec3& normal, const Vec3&) {
        for (std::size_t a = 0; a < body_albedos.size(); ++a) {
          const double weight = std::pow(body_albedos[a], static_cast<double>(order));
          add(a, 0, entry_averaged, weight);
          add(a, 1, entry_averaged, weight * flat_sky[a].at(glm::dot(normal, view.key)));
        }
      });
      const double transmission = 1 - fresnel_dielectric(mu, 1.5);
      const PointShape at_exit(view.body.shape(xe), thickest_body);
      const BodyCells cells(view.body, xe);
      const auto s = [&](double albedo, const PairShape& pair) {
        return baseline_profile().evaluate_over_albedo(albedo, pair.distance) *
               baseline_shapes().factor(pair, Rgb(albedo), Rgb(1)).r;
      };
      for (std::size_t a = 0; a < body_albedos.size(); ++a)
        for (int light = 0; light < 2; ++light)
          for (int q = 0; q < basis; ++q) {
            const double m = pixel.value[a][light][q] / photons;
            pixel.variance[a][light][q] =
                transmission * transmission * (pixel.variance[a][light][q] / photons - m * m) / photons;
            pixel.value[a][light][q] = transmission * m;
          }
      for (const BodyCell& cell : cells.cells()) {
        const PairShape pair = pair_shape(cell.position, cell.shape, xe, at_exit);
        const double key = glm::dot(cell.shape.normal, view.key);
        for (std::size_t a = 0; a < body_albedos.size(); ++a) {
          const double albedo = body_albedos[a];
          const double all = transmission * cell.area * albedo * s(albedo, pair);
          const LightAim aim(baseline_shapes().aim(pair, Rgb(albedo), Rgb(1)), cell.position,
                             cell.shape.normal, xe, n, view.camera);
          for (int light = 0; light < 2; ++light) {
            const double flat = light ? flat_sky[a].at(key) : 1;
            pixel.value[a][light][basis] += all * flat;
            pixel.value[a][light][basis_aimed] +=
                all * flat * directions.mean(aim, light == 1, cell.shape.normal);
          }
        }
      }
    }
  });
  for (int light = 0; light < 2; ++light)
    for (std::size_t a = 0; a < body_albedos.size(); ++a) {
      // Error of a sum of quantities against the exact image, without noise.
      const auto error = [&](std::initializer_list<std::pair<Quantity, double>> terms) {
        double square = 0, reference = 0, mean = 0, truth = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
          const auto& v = pixels[i].value[a][light];
          const auto& var = pixels[i].variance[a][light];
          double sum = 0, noise = 0, own = 1;  // what is left of the exact image's own noise
          for (const auto& [q, f] : terms) {
            sum += f * v[q];
            if (q == exact_once || q == exact_twice) {
              // A part of the exact image cancels there.
              own = std::max(0.0, (var[exact] - var[q]) / var[exact]);
              continue;
            }
            if (f > 0) noise += var[q];
          }
          square += view.share[i] * ((sum - v[exact]) * (sum - v[exact]) - noise - own * var[exact]);
          reference += view.share[i] * v[exact] * v[exact];
          mean += view.share[i] * sum;
          truth += view.share[i] * v[exact];
        }
        std::printf(" | %.3f %+.0f", std::copysign(std::sqrt(std::abs(square / reference)), square),
                    100 * (mean / truth - 1));
      };
      std::printf("%-12s %-7s %.2f", view.body.name.c_str(), light ? "sky" : "uniform", body_albedos[a]);
      error({{averaged, 1.0}});
      error({{exit_averaged, 1.0}});
      error({{entry_averaged, 1.0}});
      error({{plane_lobes, 1.0}});
      error({{body_lobes, 1.0}});
      error({{averaged, 1.0}, {averaged_once, -1.0}, {exact_once, 1.0}});
      error({{averaged, 1.0}, {averaged_twice, -1.0}, {exact_twice, 1.0}});
      error({{basis, 1.0}});
      error({{basis_aimed, 1.0}});
      std::printf("\n");
    }
}

}  // namespace

TEST_CASE("what errors of images are made of", "[.][bench]") {
  std::printf(
      "error of the image (RMSE/RMS) and of its mean in per cent: perfect S | exit averaged | entry averaged "
      "| "
      "perfect S with lobes of the plane, of the body | perfect S with order 1 exact, orders 1 and 2 exact | "
      "shape basis not aimed | shape basis\n");
  const Vec3 front(0, 0.15, 1), above(0.25, 0.75, 1), key(-0.6, 0.62, 0.5);
  for (const double r : {1.0, 3.0, 10.0, 30.0})
    print(make_view(make_ellipsoid_body("sphere " + std::to_string(int(r)), Vec3(r)), front, key, 160),
          WalkBody::ball(r), 2000);
  print(make_view(make_torus_body("torus 9/3", 9, 3), above, key, 160), WalkBody::ball(6), 2000);
  for (const double t : {2.0, 5.0}) {
    print({make_slab_body("slab " + std::to_string(int(t)), t, 60),
           glm::normalize(Vec3(0.25, -1, 1.2)),
           glm::normalize(Vec3(-0.5, 0.3, -0.75)),
           {Vec3(0.01, 0.02, 0)},
           {1}},
          WalkBody::slab(t), 200000);
  }
}

namespace {

// Length of an arc with that chord and those normals at its ends: the chord corrected by the normals.
double arc(const Vec3& a, const PointShape& at_a, const Vec3& b, const PointShape& at_b) {
  const double half = 0.5 * std::acos(std::clamp(glm::dot(at_a.normal, at_b.normal), -1.0, 1.0));
  return glm::distance(a, b) * (half > 1e-6 ? half / std::sin(half) : 1);
}

// Irradiance that enters from a far light in one direction, by the cosine to it; any unit.
double beam_entering(double cosine) {
  return cosine > 0 ? cosine * (1 - fresnel_dielectric(cosine, 1.5)) : 0;
}

constexpr int lights = 3;
constexpr const char* light_name[lights] = {"uniform", "sky", "beam"};

// Of one exit, by light: radiosity by walks, by the shape basis, and by the half-space's S at chords and at
// arcs.
struct ExitRadiosity {
  double walked[lights]{}, variance[lights]{}, shape[lights]{}, chord[lights]{}, arc[lights]{};
};

void compare(const BodyView& view, int photons) {
  const Sky sky{0.15, 3, view.key};
  const Entering entering(sky, Lobe());
  const auto entered = [&](const Vec3& normal) {
    const double cosine = glm::dot(normal, view.key);
    return std::array<double, lights>{1, entering.at(cosine), beam_entering(cosine)};
  };
  std::vector<std::array<ExitRadiosity, body_albedos.size()>> exits(view.exits.size());
  parallel_for(exits.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 xe = view.exits[i];
      walk_pixel(view, xe, true, photons, i, [&](int64_t order, const Vec3& normal, const Vec3&) {
        const auto light = entered(normal);
        for (std::size_t a = 0; a < body_albedos.size(); ++a) {
          const double weight = std::pow(body_albedos[a], static_cast<double>(order));
          for (std::size_t l = 0; l < lights; ++l) {
            exits[i][a].walked[l] += weight * light[l];
            exits[i][a].variance[l] += weight * light[l] * weight * light[l];
          }
        }
      });
      for (ExitRadiosity& exit : exits[i])
        for (std::size_t l = 0; l < lights; ++l) {
          exit.walked[l] /= photons;
          exit.variance[l] = (exit.variance[l] / photons - exit.walked[l] * exit.walked[l]) / (photons - 1);
        }
      const PointShape at_exit(view.body.shape(xe), thickest_body);
      const BodyCells cells(view.body, xe);
      for (const BodyCell& cell : cells.cells()) {
        const PairShape pair = pair_shape(cell.position, cell.shape, xe, at_exit);
        const double along = arc(cell.position, cell.shape, xe, at_exit);
        const auto light = entered(cell.shape.normal);
        for (std::size_t a = 0; a < body_albedos.size(); ++a) {
          const double albedo = body_albedos[a];
          const double chord = cell.area * baseline_profile().evaluate(albedo, pair.distance);
          const double arc = cell.area * baseline_profile().evaluate(albedo, along);
          const double factor = baseline_shapes().factor(pair, Rgb(albedo), Rgb(1)).r;
          for (std::size_t l = 0; l < lights; ++l) {
            exits[i][a].chord[l] += light[l] * chord;
            exits[i][a].arc[l] += light[l] * arc;
            exits[i][a].shape[l] += light[l] * factor * chord;
          }
        }
      }
    }
  });
  for (std::size_t light = 0; light < lights; ++light)
    for (std::size_t a = 0; a < body_albedos.size(); ++a) {
      const auto mean = [&](const auto& of) {
        double sum = 0;
        for (std::size_t i = 0; i < exits.size(); ++i) sum += view.share[i] * of(exits[i][a]);
        return sum;
      };
      using E = const ExitRadiosity&;
      const double truth = mean([&](E e) { return e.walked[light] * e.walked[light] - e.variance[light]; });
      const double noise = mean([&](E e) { return e.variance[light]; });
      const double total = mean([&](E e) { return e.walked[light]; });
      const auto error = [&](const auto& of) {
        const double square = mean([&](E e) {
          const double off = of(e) - e.walked[light];
          return off * off - e.variance[light];
        });
        std::printf(" | %.3f %+.0f", std::copysign(std::sqrt(std::abs(square / truth)), square),
                    100 * (mean(of) / total - 1));
      };
      const double all = mean([](E e) { return e.walked[0]; });
      const double chord = all / mean([](E e) { return e.chord[0]; });
      const double arcs = all / mean([](E e) { return e.arc[0]; });
      // The factor of a point is the shape basis's: the walks' would bring their noise with it.
      std::printf("%-12s %-7s %.2f", view.body.name.c_str(), light_name[light], body_albedos[a]);
      error([&](E e) { return e.chord[light]; });
      error([&](E e) { return e.arc[light]; });
      error([&](E e) { return chord * e.chord[light]; });
      error([&](E e) { return arcs * e.arc[light]; });
      error([&](E e) { return e.shape[0] / e.chord[0] * e.chord[light]; });
      error([&](E e) { return e.shape[0] / e.arc[0] * e.arc[light]; });
      error([&](E e) { return e.shape[light]; });
      std::printf(" (noise %.3f)\n", std::sqrt(noise / truth));
    }
}

}  // namespace

TEST_CASE("what cheaper corrections of the half-space would buy", "[.][bench]") {
  std::printf(
      "error of the radiosity's image (RMSE/RMS, without the walks' noise) and of its mean in per cent: "
      "half-space by chord, by arc | one factor per object, by chord, by arc | one factor per point, by "
      "chord, "
      "by arc | shape\n");
  const Vec3 front(0, 0.15, 1), above(0.25, 0.75, 1), key(-0.6, 0.62, 0.5);
  compare(make_view(make_ellipsoid_body("sphere 3", Vec3(3)), front, key, 100), 4000);
  compare(make_view(make_torus_body("torus 9/3", 9, 3), above, key, 100), 4000);
  compare(make_view(make_blob_body("blob 10", 10, 0.2), front, key, 100), 4000);
  compare({make_slab_body("slab 2", 2, 60),
           glm::normalize(Vec3(0.25, -1, 1.2)),
           glm::normalize(Vec3(-0.5, 0.3, -0.75)),
           {Vec3(0.01, 0.02, 0), Vec3(0.01, 0.02, -2)},
           {0.5, 0.5}},
          200000);
}
