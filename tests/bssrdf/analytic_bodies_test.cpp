#include <catch2/catch.hpp>

#include "bssrdf/body_transfer.h"

using namespace alabaster;

TEST_CASE("rays within bodies by equations end where they first meet the surface", "[bssrdf]") {
  Rng rng(8);
  const auto direction = [&] {
    for (;;) {
      const Vec3 v(2 * rng.uniform() - 1, 2 * rng.uniform() - 1, 2 * rng.uniform() - 1);
      if (glm::length(v) < 1 && glm::length(v) > 0.1) return glm::normalize(v);
    }
  };
  // Positive inside: the distance to the nearest point that onto() gives, along the normal there.
  const auto depth = [](const AnalyticBody& body, const Vec3& p) {
    const Vec3 on = body.onto(p);
    return glm::dot(on - p, body.normal(on));
  };
  for (const AnalyticBody& body :
       {make_blob_body("blob", 10, 0.2), make_torus_body("torus", 9, 3), make_cavity_body("cavity", 3),
        make_ellipsoid_body("ellipsoid", Vec3(3, 9, 3))})
    for (int k = 0; k < 400; ++k) {
      INFO(body.name << " " << k);
      // From the surface inwards, as grazing as it comes, or from within.
      const Vec3 on = body.onto(body.patches[0](Vec2(rng.uniform(), rng.uniform())));
      Vec3 w = direction();
      if (glm::dot(w, body.normal(on)) > 0) w = -w;
      const Vec3 p = k % 2 ? on : on - rng.uniform() * body.normal(on);
      const double boundary = body.boundary(p, w), end = std::min(boundary, 50.0);
      for (int i = 1; i < 400; ++i) REQUIRE(depth(body, p + (end * i / 400) * w) > -1e-4);
      if (boundary > 50) continue;
      CHECK(std::abs(depth(body, p + boundary * w)) < 1e-4);
      CHECK(glm::dot(body.normal(p + boundary * w), w) > -1e-3);
    }
}
