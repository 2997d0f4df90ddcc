#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "geometry/mesh.h"

namespace alabaster {

/// Points uniform by area on some of a mesh's triangles, in constant time (alias method, Vose 1991).
class AreaSampler {
 public:
  AreaSampler() = default;
  AreaSampler(const TriangleMesh& mesh, const std::function<bool(uint32_t triangle)>& counts);

  double area() const { return area_; }  // m^2; 0 when there is no triangle
  /// Triangle and barycentric weights of its second and third corner; area() > 0.
  std::pair<uint32_t, Vec2> sample(Vec2 u) const;

 private:
  struct Column {
    float keep;  // probability of the column's own triangle
    uint32_t triangle, alias;
  };
  std::vector<Column> columns_;
  double area_ = 0;
};

}  // namespace alabaster
