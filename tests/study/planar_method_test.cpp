#include "study/planar_method.h"

#include <catch2/catch.hpp>

#include "core/error.h"

using namespace alabaster;

TEST_CASE("method names say model, variant and sampling") {
  CHECK(parse_planar_method("composite").sampling == PlanarSampling::clipped);
  CHECK(parse_planar_method("composite:symmetric").model == "composite:symmetric");
  CHECK(parse_planar_method("composite:order1:uniform").sampling == PlanarSampling::uniform);
  const PlanarMethod aggregate = parse_planar_method("aggregate:0.5:mc32:mis");
  CHECK(aggregate.model == "aggregate");
  CHECK(aggregate.options.ellipse_width == 0.5);
  CHECK(aggregate.options.ellipse_samples == 32);
  CHECK(aggregate.sampling == PlanarSampling::mis);
  for (const char* bad : {"", "bogus", "composite:bogus", "homogeneous:symmetric", "aggregate:-1",
                          "aggregate:mc0", "composite:0.5", "composite:"})
    CHECK_THROWS_AS(parse_planar_method(bad), InputError);
}
