#include "study/response.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/statistics.h"
#include "geometry/shapes.h"
#include "study/scene_recipe.h"
#include "support/paths.h"

using namespace alabaster;

namespace {

/// A box so large, in mean free paths of 1 mm, that its middle is a half-space, of one albedo.
Scene large_box(double albedo) {
  SceneRecipe recipe;
  recipe.id = "box";
  RecipePart part;
  part.name = "stone";
  part.mesh = make_slab(0.4, 0.1, 8);
  part.medium = Medium{Rgb(0.001), 0.3, 1.5};
  part.meaning = AlbedoSource::Meaning::albedo;
  part.colour = Rgb(albedo);
  recipe.parts.push_back(std::move(part));
  recipe.camera.position = {0, 1, 0};
  recipe.camera.direction = {0, -1, 0};
  recipe.camera.up = {0, 0, -1};
  return build_scene(std::move(recipe));
}

ExitPoint middle_of(const Scene& scene) {
  const auto hit = scene.rays.nearest(Ray{{0.0031, 1, 0.0042}, {0, -1, 0}});
  REQUIRE(hit);
  const SceneObject& object = scene.objects[hit->object];
  ExitPoint exit{"light", hit->object, object.mesh.surface_point(hit->triangle, hit->barycentric), {}};
  exit.surface.object = hit->object;
  exit.albedo = object.albedo->at(exit.surface);
  return exit;
}

/// Integral of 2 pi rho R over a bin of distances.
double basis_in(int bin, double albedo) {
  const ProfileTable& profile = baseline_profile();
  const double low = std::max(1e-6, ResponseBins::low(bin)), high = ResponseBins::high(bin);
  constexpr int steps = 400;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {  // midpoints in the logarithm
    const double step = std::log(high / low) / steps, rho = low * std::exp((i + 0.5) * step);
    sum += 2 * pi * rho * profile.evaluate(albedo, rho) * rho * step;
  }
  return sum;
}

double sum_of(const std::array<double, 3>& by_contrast) {
  return by_contrast[0] + by_contrast[1] + by_contrast[2];
}

}  // namespace

TEST_CASE("distances and contrasts fall into their bins") {
  CHECK(ResponseBins::of(0) == 0);
  for (int bin = 0; bin < ResponseBins::count; ++bin) {
    const double inside = bin == 0 ? 0.01 : std::sqrt(ResponseBins::low(bin) * ResponseBins::high(bin));
    CHECK(ResponseBins::of(inside) == bin);
    if (bin > 0) CHECK(ResponseBins::low(bin) == Approx(ResponseBins::high(bin - 1)));
  }
  CHECK(ResponseBins::of(1e9) == ResponseBins::count - 1);
  CHECK(contrast_of(Rgb(0.5), Rgb(0.55)) == Contrast::low);
  CHECK(contrast_of(Rgb(0.3), Rgb(0.5)) == Contrast::middle);
  CHECK(contrast_of(Rgb(0.95), Rgb(0.5)) == Contrast::high);
}

TEST_CASE("on a large flat box the tally is the half-space's basis") {
  for (const double albedo : {0.5, 0.9}) {
    const Scene scene = large_box(albedo);
    const ResponseSums tally = tally_response(scene, middle_of(scene), WalkAlbedo::closest_point, 200000, 7);
    double chi_square = 0, tests = 0;
    for (int bin = 0; bin < ResponseBins::count; ++bin) {
      const auto b = static_cast<std::size_t>(bin);
      const double expected = basis_in(bin, albedo), value = sum_of(tally.value[b]);
      const double variance = sum_of(tally.variance[b]);
      if (expected < 1e-3) continue;  // too few walks for a normal distribution
      INFO("albedo " << albedo << ", distances from " << ResponseBins::low(bin) << ": " << value
                     << " against " << expected);
      // Up to the table's own interpolation, 0.3 % (docs/optics.md).
      const double spread = variance + std::pow(0.003 * expected, 2);
      CHECK(std::abs(value - expected) < 4.5 * std::sqrt(spread));
      chi_square += (value - expected) * (value - expected) / spread;
      ++tests;
    }
    CHECK(tests > 10);
    CHECK(chi_square_p_value(chi_square, tests) > 1e-4);
    CHECK(tally.total() == Approx(baseline_profile().reflectance(albedo)).epsilon(0.02));
  }
}

TEST_CASE("the integral of a model over a large flat box is the basis, distance by distance") {
  const Scene scene = large_box(0.8);
  const ResponseSums sums =
      integrate_response(scene, middle_of(scene), parse_mesh_method("composite+half-space"), 3);
  for (int bin = 3; bin < ResponseBins::count; ++bin) {
    const double expected = basis_in(bin, 0.8);
    if (expected < 1e-4) continue;
    INFO("distances from " << ResponseBins::low(bin));
    CHECK(sum_of(sums.value[static_cast<std::size_t>(bin)]) == Approx(expected).epsilon(0.03));
  }
  CHECK(sums.total() == Approx(baseline_profile().reflectance(0.8)).epsilon(0.02));
}

TEST_CASE("exits are chosen light and dark, where the camera sees them") {
  const MeshScene scene = load_mesh_scene("sphere_10", 16);
  const auto exits = choose_exits(scene);
  REQUIRE(exits.size() == 2);
  CHECK(exits[0].albedo.mean() > 0.9);
  CHECK(exits[1].albedo.mean() < 0.55);
  for (const ExitPoint& exit : exits)
    CHECK(glm::dot(exit.surface.geometric_normal, scene.scene.cameras.front().direction) < 0);
}

TEST_CASE("responses are written by distance and contrast, with a page") {
  const ScratchFolder folder;
  ValidationOptions options;
  options.scenes = {"sphere_3"};
  options.models = {"composite+half-space", "walk"};
  options.output = folder / "response";
  options.response_budget = ResponseBudget{4000, 24};
  const auto results = validate_response(options);
  REQUIRE(results.size() == 2);
  const auto rows = nlohmann::json::parse(read_text(options.output / "response.json"));
  REQUIRE(rows.size() > 20);
  double reference = 0, walk = 0;
  for (const auto& row : rows) {
    CHECK(row.at("scene") == "sphere_3");
    if (row.at("exit") == "light" && row.at("model") == "walk") {
      reference += row.at("reference").get<double>();
      walk += row.at("value").get<double>();
    }
  }
  CHECK(reference == Approx(results[0].reference.total()));
  CHECK(walk > reference);  // a light exit makes the whole body light
  CHECK(read_text(options.output / "response.csv").find("composite+half-space") != std::string::npos);
  CHECK(read_text(options.output / "response.html").find("dark exit") != std::string::npos);
  options.scenes = {"stripes1"};
  CHECK_THROWS(validate_response(options));
}
