#include "texture/patterns.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/error.h"
#include "core/rng.h"
#include "geometry/shapes.h"
#include "texture/noise.h"
#include "texture/solid_texture.h"

using namespace alabaster;

namespace {

double share_of(const TexelArray& texels, double value) {
  std::size_t count = 0;
  for (const Vec4f& t : texels.texels) count += std::abs(static_cast<double>(t.r) - value) < 1e-6;
  return static_cast<double>(count) / static_cast<double>(texels.texels.size());
}

bool inside_triangle(const std::array<Vec2, 3>& c, Vec2 p) {
  bool left = true, right = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 a = c[(k + 1) % 3] - c[k], b = p - c[k];
    const double side = a.x * b.y - a.y * b.x;
    left = left && side >= 0, right = right && side <= 0;
  }
  return left || right;
}

}  // namespace

TEST_CASE("every pattern repeats over its tile, is deterministic, and is an albedo") {
  Rng rng(5);
  for (const std::string& name : pattern_names()) {
    INFO(name);
    const TilePattern pattern = tile_pattern(name), again = tile_pattern(name);
    for (int n = 0; n < 500; ++n) {
      const Vec2 uv(rng.uniform(), rng.uniform());
      // 2^-20 steps: adding 1 is then exact.
      const Vec2 grid = glm::floor(uv * 1048576.0) / 1048576.0;
      const Rgb value = pattern(grid);
      REQUIRE(value == again(grid));
      REQUIRE(value.min() >= 0);
      REQUIRE(value.max() <= 1);
      for (const Vec2 shift : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 1)}) {
        const Rgb shifted = pattern(grid + shift);
        // A point within rounding of a pattern's edge may fall on either side: none of these 500 does.
        REQUIRE((shifted - value).max() < 1e-6);
        REQUIRE((value - shifted).max() < 1e-6);
      }
    }
  }
}

TEST_CASE("two-tone patterns show the tones they are asked for") {
  const Tones tones{Rgb(0.9), Rgb(0.25)};
  for (const std::string& name : pattern_names()) {
    if (name == "cork" || name == "logo") continue;
    INFO(name);
    const TexelArray texels = make_pattern(name, 80, tones);
    for (const Vec4f& t : texels.texels) {
      REQUIRE(t.r >= 0.25f - 1e-6f);
      REQUIRE(t.r <= 0.9f + 1e-6f);
      REQUIRE(t.r == t.g);
      REQUIRE(t.a == 1);
    }
    CHECK(share_of(texels, 0.9) > 0.04);
    CHECK((name == "constant" || share_of(texels, 0.25) > 0.04));
  }
}

TEST_CASE("stripes, checker and dots have the periods they document") {
  for (const auto& [name, period] : {std::pair<std::string, int>{"stripes1", 40}, {"stripes2", 10}}) {
    const TexelArray texels = make_pattern(name, 400);
    for (int x = 0; x < 400; ++x) REQUIRE(texels.at(x, x / 2).r == (x % period < period / 2 ? 0.95f : 0.5f));
  }
  const TexelArray checker = make_pattern("checker", 400);
  for (int x = 0; x < 400; ++x)
    REQUIRE(checker.at(x, 7 * x % 400).r == ((x / 40 + 7 * x % 400 / 40) % 2 == 0 ? 0.95f : 0.5f));
  // 100 disks of radius 0.03: their area, by 16 points per texel.
  double light = 0;
  const TexelArray dots = make_pattern("dots", 400);
  for (const Vec4f& t : dots.texels) light += (static_cast<double>(t.r) - 0.5) / 0.45 / 160000;
  CHECK(light == Approx(pi * 0.09).epsilon(0.005));
}

TEST_CASE("an unknown pattern is refused by name") {
  CHECK_THROWS_WITH(tile_pattern("plaid"), Catch::Contains("plaid") && Catch::Contains("stripes1"));
}

TEST_CASE("noise is continuous, repeats, and has mean zero (z-test, significance 1e-4)") {
  Rng rng(9);
  double sum = 0, squares = 0;
  const int n = 4000;
  for (int k = 0; k < n; ++k) {
    // Points far apart: independent up to the lattice's reach.
    const Vec3 p(100 * rng.uniform(), 100 * rng.uniform(), 100 * rng.uniform());
    const double value = gradient_noise(p, 3);
    REQUIRE(std::abs(value) < 1.2);
    REQUIRE(std::abs(gradient_noise(p + Vec3(1e-6), 3) - value) < 2e-5);
    sum += value, squares += value * value;
    REQUIRE(gradient_noise(p + Vec3(8, 0, -16), 3, 8) == Approx(gradient_noise(p, 3, 8)).margin(1e-9));
  }
  CHECK(std::abs(sum) / std::sqrt(squares) < 3.9);
  const CellularNoise a = cellular_noise({1.3, 7.9}, 4, 8), b = cellular_noise({9.3, -0.1}, 4, 8);
  CHECK(a.nearest == Approx(b.nearest).margin(1e-9));
  CHECK(a.id == b.id);
  CHECK(a.nearest <= a.second);
}

TEST_CASE("a baked solid texture has at each texel the value of the surface point there") {
  // Linear in space, so that the mean over a texel's footprint is the value at its centre.
  const SolidPattern ramp = [](const Vec3& p) {
    return Rgb(0.5 + 0.2 * p.x, 0.5 + 0.1 * p.y, 0.5 - 0.2 * p.z);
  };
  const int size = 128;
  for (const TriangleMesh& mesh : {make_blob(1, 0.2, 48), make_cylinder(0.5, 1, 48)}) {
    const TexelArray texels = bake_solid(mesh, size, size, ramp, Rgb(0.123));
    int checked = 0;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      std::array<Vec2, 3> c;
      for (std::size_t k = 0; k < 3; ++k) c[k] = Vec2(mesh.uv_sets[0][mesh.attributes[t][k]]) * double{size};
      const Vec2 centre = glm::floor((c[0] + c[1] + c[2]) / 3.0) + 0.5;
      if (!inside_triangle(c, centre)) continue;
      const Mat2 edges(c[1] - c[0], c[2] - c[0]);
      const Rgb expected = ramp(mesh.position(t, glm::inverse(edges) * (centre - c[0])));
      const Vec4f& found = texels.at(static_cast<int>(centre.x), static_cast<int>(centre.y));
      for (int k = 0; k < 3; ++k) REQUIRE(static_cast<double>(found[k]) == Approx(expected[k]).margin(1e-5));
      REQUIRE(found.a == 1);
      ++checked;
    }
    CHECK(checked > 500);
    CHECK(texels.at(0, 0) == Vec4f(0.123f, 0.123f, 0.123f, 0));  // beyond the gutter's two texels
  }
}

TEST_CASE("the charts of a baked texture agree along their seams") {
  // At a border vertex every chart's bilinear lookup must give the solid pattern's value: nothing of the
  // gutter.
  const SolidPattern ramp = [](const Vec3& p) {
    return Rgb(0.5 + 0.2 * p.x, 0.5 + 0.1 * p.y, 0.5 - 0.2 * p.z);
  };
  const TriangleMesh mesh = make_blob(1, 0.2, 64);
  const int size = 256;
  const auto texels = std::make_shared<TexelArray>(bake_solid(mesh, size, size, ramp, Rgb(0)));
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 p = Vec2(mesh.uv_sets[0][mesh.attributes[t][k]]) * double{size} - 0.5;
      const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y));
      const Vec2 f = p - Vec2(x, y);
      const Vec4 found =
          (1 - f.y) * ((1 - f.x) * Vec4(texels->at(x, y)) + f.x * Vec4(texels->at(x + 1, y))) +
          f.y * ((1 - f.x) * Vec4(texels->at(x, y + 1)) + f.x * Vec4(texels->at(x + 1, y + 1)));
      const Rgb expected = ramp(mesh.positions[mesh.corners[t][k]]);
      for (int c = 0; c < 3; ++c) REQUIRE(found[c] == Approx(expected[c]).margin(2e-3));
      REQUIRE(found.a == Approx(1));
    }
}

TEST_CASE("solid patterns show both tones at the size asked for") {
  const Tones tones{Rgb(0.95), Rgb(0.5)};
  const SolidPattern stripes = solid_stripes({0, 2, 0}, 0.1, tones);
  CHECK(stripes({7, 0.01, 3}) == tones.light);
  CHECK(stripes({-2, 0.06, 1}) == tones.dark);
  CHECK(stripes({0, 0.11, 0}) == tones.light);
  CHECK(stripes({0, -0.01, 0}) == tones.dark);
  const SolidPattern checker = solid_checker(0.5, tones);
  CHECK(checker({0.1, 0.1, 0.1}) == tones.light);
  CHECK(checker({0.6, 0.1, 0.1}) == tones.dark);
  CHECK(checker({-0.1, 0.1, 0.6}) == tones.light);

  StoneParameters parameters;
  parameters.scale = 0.2;
  const SolidPattern stone = solid_stone(parameters);
  Rng rng(1);
  double least = 1, greatest = 0;
  for (int n = 0; n < 2000; ++n) {
    const Rgb value = stone({rng.uniform(), rng.uniform(), rng.uniform()});
    least = std::min(least, value.min()), greatest = std::max(greatest, value.max());
  }
  CHECK(least >= parameters.vein.min());
  CHECK(least < 0.8);  // veins there are
  CHECK(greatest <= parameters.body.max());
  CHECK(greatest > 0.95);
}
