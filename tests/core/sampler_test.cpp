#include "core/sampler.h"

#include <catch2/catch.hpp>
#include <set>
#include <vector>

#include "core/statistics.h"

using namespace alabaster;

TEST_CASE("sample groups tile the indices without gaps") {
  uint32_t k = 0;
  for (uint32_t size_class = 0; size_class < 4; ++size_class)
    for (uint32_t group = 0; group < 16; ++group)
      for (uint32_t i = 0; i < (4u << size_class); ++i, ++k) {
        const SampleGroup g = sample_group(k);
        REQUIRE(g.size_class == size_class);
        REQUIRE(g.group == group);
        REQUIRE(g.index == i);
      }
}

TEST_CASE("a sample depends on pixel, index, seed and name only") {
  for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent}) {
    Sampler a(kind, 7), b(kind, 7), other_seed(kind, 8);
    a.start(3, 4, 100);
    b.start(9, 9, 1);
    b.start(3, 4, 100);
    other_seed.start(3, 4, 100);
    CHECK(a.get_2d(Dimension::lens) == b.get_2d(Dimension::lens));
    CHECK(a.get_1d(Dimension::lobe, 2) == b.get_1d(Dimension::lobe, 2));
    CHECK(a.get_1d(Dimension::lobe) != other_seed.get_1d(Dimension::lobe));
    CHECK(a.get_1d(Dimension::lobe) != a.get_1d(Dimension::lobe, 1));
    CHECK(a.get_1d(Dimension::lobe) != a.get_1d(Dimension::lens));
  }
}

TEST_CASE("one Sobol group of 64 is stratified in 64 boxes of every elementary shape") {
  Sampler sampler(SamplerKind::sobol, 1);
  // Group 0 of class 4 (size 64) starts at 64 * 15.
  for (int log_width = 0; log_width <= 6; ++log_width) {
    std::set<int> boxes;
    for (uint32_t i = 0; i < 64; ++i) {
      sampler.start(5, 6, 64 * 15 + i);
      const Vec2 u = sampler.get_2d(Dimension::light_point);
      const int columns = 1 << log_width, rows = 64 / columns;
      boxes.insert(static_cast<int>(u.x * columns) * rows + static_cast<int>(u.y * rows));
    }
    CHECK(boxes.size() == 64);
  }
}

TEST_CASE("every sampler is uniform (chi-square, 256 bins, significance 1e-4)") {
  for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent}) {
    Sampler sampler(kind, 42);
    std::vector<double> bins(256);
    const int n = 256 * 100;
    for (int i = 0; i < n; ++i) {
      sampler.start(i % 160, i / 160, 0);  // one sample of many pixels: independent in either sampler
      const Vec2 u = sampler.get_2d(Dimension::pixel);
      REQUIRE(u.x >= 0);
      REQUIRE(u.x < 1);
      bins[static_cast<std::size_t>(u.x * 16) * 16 + static_cast<std::size_t>(u.y * 16)] += 1;
    }
    double statistic = 0;
    for (const double count : bins) statistic += (count - 100) * (count - 100) / 100;
    CHECK(chi_square_p_value(statistic, 255) > 1e-4);
  }
}

TEST_CASE("chi-square and normal p-values match tables") {
  // Abramowitz & Stegun tables 26.8 and 26.1.
  CHECK(chi_square_p_value(3.84146, 1) == Approx(0.05).margin(1e-5));
  CHECK(chi_square_p_value(18.3070, 10) == Approx(0.05).margin(1e-5));
  CHECK(chi_square_p_value(149.449, 100) == Approx(0.001).margin(1e-5));
  CHECK(two_sided_normal_p_value(1.959964) == Approx(0.05).margin(1e-6));
}
