#include <catch2/catch.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "bssrdf/body_transfer.h"

using namespace alabaster;

// The table of docs/shape_basis.md: radiosity of places on bodies by equations, by photon walks in the exact
// shape and by the bases, homogeneous albedos. Errors in per cent at the albedos 0.5, 0.8, 0.95, 0.99.

namespace {

struct Place {
  AnalyticBody body;
  Vec3 exit;
  const char* where;
};

std::string with_size(const char* name, double size) {
  char text[64];
  std::snprintf(text, sizeof text, "%s %g", name, size);
  return text;
}

// Where the larger curvature is largest, the smaller one's mean with it smallest, their product smallest.
Vec3 extreme_place(const AnalyticBody& body, const std::string& where) {
  Rng rng(5);
  Vec3 best(0);
  double most = -HUGE_VAL;
  for (int k = 0; k < 3000; ++k) {
    const Vec3 p = body.onto(body.patches[0](Vec2(rng.uniform(), rng.uniform())));
    const LocalShape shape = body.shape(p);
    const double a = shape.curvature_min, b = shape.curvature_max;
    const double score = where == "bump" ? a + b : where == "hollow" ? -a - b : -a * b;
    if (score <= most) continue;
    most = score;
    best = p;
  }
  return best;
}

std::vector<Place> places() {
  std::vector<Place> all;
  const auto add = [&](const AnalyticBody& body, const Vec3& exit, const char* where) {
    all.push_back({body, body.onto(exit), where});
  };
  for (const double r : {30.0, 10.0, 3.0, 1.0})
    add(make_ellipsoid_body(with_size("sphere", r), Vec3(r)), Vec3(r, 0.3 * r, 0.1 * r), "");
  for (const double t : {10.0, 5.0, 2.0, 1.0})
    add(make_slab_body(with_size("slab", t), t, 60), Vec3(0.01, 0.02, 0), "");
  for (const double r : {10.0, 3.0, 1.0}) {
    add(make_cylinder_body(with_size("cylinder", r), r, 60), Vec3(r, 0.3, 0.1), "");
    const AnalyticBody prolate = make_ellipsoid_body(with_size("1:3:1 x", r), Vec3(r, 3 * r, r));
    add(prolate, Vec3(0.02 * r, 3 * r, 0.03 * r), "tip");
    add(prolate, Vec3(0.5 * r, 2.2 * r, 0.3 * r), "between");
    add(prolate, Vec3(r, 0.1 * r, 0.05 * r), "side");
    const AnalyticBody oblate = make_ellipsoid_body(with_size("3:1:3 x", r), Vec3(3 * r, r, 3 * r));
    add(oblate, Vec3(0.05 * r, r, 0.03 * r), "flat");
    add(oblate, Vec3(2.2 * r, 0.6 * r, 0.3 * r), "between");
    add(oblate, Vec3(3 * r, 0.03 * r, 0.05 * r), "rim");
  }
  for (const auto& [ring, tube] : {std::pair{30.0, 10.0}, {15.0, 10.0}, {9.0, 3.0}, {6.0, 3.0}, {3.0, 1.0}}) {
    const AnalyticBody torus =
        make_torus_body(with_size(("torus " + std::to_string(int(ring)) + "/").c_str(), tube), ring, tube);
    add(torus, Vec3(ring + tube, 0.01, 0.02 * tube), "outside");
    add(torus, Vec3(ring, tube, 0.02 * tube), "top");
    add(torus, Vec3(ring - tube, 0.01 * tube, 0.02 * tube), "saddle");
  }
  for (const double r : {10.0, 3.0, 1.0})
    add(make_cavity_body(with_size("cavity", r), r), Vec3(r, 0.3 * r, 0.1 * r), "");
  for (const double r : {30.0, 10.0}) {
    const AnalyticBody blob = make_blob_body(with_size("blob", r), r, 0.2);
    for (const char* where : {"bump", "hollow", "saddle"}) add(blob, extreme_place(blob, where), where);
  }
  return all;
}

// Length of an arc with that chord and those normals at its ends: the usual stand-in for the geodesic.
double arc(const Vec3& a, const PointShape& at_a, const Vec3& b, const PointShape& at_b) {
  const double half = 0.5 * std::acos(std::clamp(glm::dot(at_a.normal, at_b.normal), -1.0, 1.0));
  return glm::distance(a, b) * (half > 1e-6 ? half / std::sin(half) : 1);
}

struct Row {
  BodyRadiosity walked, half_space, geodesic, shape;
};

Row measure(const Place& place) {
  const PointShape at_exit(place.body.shape(place.exit), thickest_body);
  const BodyCells cells(place.body, place.exit);
  const auto predict = [&](const auto& basis) {
    return predicted_radiosity(cells.cells(), place.exit, at_exit, basis);
  };
  Row row;
  row.walked = walk_radiosity(place.body, place.exit, 200000, {});
  row.half_space =
      predict([](const Vec3& xi, const PointShape&, const Vec3& xe, const PointShape&, double albedo) {
        return baseline_profile().evaluate(albedo, glm::distance(xi, xe));
      });
  row.geodesic =
      predict([](const Vec3& xi, const PointShape& si, const Vec3& xe, const PointShape& se, double albedo) {
        return baseline_profile().evaluate(albedo, arc(xi, si, xe, se));
      });
  row.shape =
      predict([](const Vec3& xi, const PointShape& si, const Vec3& xe, const PointShape& se, double albedo) {
        const PairShape pair = pair_shape(xi, si, xe, se);
        return baseline_profile().evaluate(albedo, pair.distance) *
               baseline_shapes().factor(pair, Rgb(albedo), Rgb(1)).r;
      });
  return row;
}

}  // namespace

TEST_CASE("radiosity of the bases on bodies by equations", "[.][bench]") {
  const std::vector<Place> all = places();
  std::vector<Row> rows(all.size());
  parallel_for(all.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) rows[k] = measure(all[k]);
  });
  std::printf(
      "half-space | arc length in the half-space | every point normalised to A | shape; uniform light; then "
      "half-space and shape lit from the front; . : not known to 5 %%\n");
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Row& row = rows[k];
    std::printf("| %s %s ", all[k].body.name.c_str(), all[k].where);
    const auto errors = [&](const auto& predicted, std::size_t light) {
      std::printf("|");
      for (std::size_t a = 0; a < body_albedos.size(); ++a) {
        const double walked = row.walked.value[a][light];
        if (row.walked.standard_error[a][light] > 0.05 * walked)
          std::printf(" .");
        else
          std::printf(" %+.0f", 100 * (predicted(a) / walked - 1));
      }
      std::printf(" ");
    };
    errors([&](std::size_t a) { return row.half_space.value[a][0]; }, 0);
    errors([&](std::size_t a) { return row.geodesic.value[a][0]; }, 0);
    errors([&](std::size_t a) { return baseline_profile().reflectance(body_albedos[a]); }, 0);
    errors([&](std::size_t a) { return row.shape.value[a][0]; }, 0);
    errors([&](std::size_t a) { return row.half_space.value[a][1]; }, 1);
    errors([&](std::size_t a) { return row.shape.value[a][1]; }, 1);
    std::printf("|\n");
  }
}
