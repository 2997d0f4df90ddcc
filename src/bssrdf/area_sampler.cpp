#include "bssrdf/area_sampler.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

AreaSampler::AreaSampler(const TriangleMesh& mesh, const std::function<bool(uint32_t)>& counts) {
  std::vector<double> share;
  for (uint32_t triangle = 0; triangle < mesh.triangle_count(); ++triangle) {
    const double area = counts(triangle) ? mesh.area(triangle) : 0;
    if (!(area > 0)) continue;
    columns_.push_back({1, triangle, triangle});
    share.push_back(area);
    area_ += area;
  }
  const auto count = static_cast<double>(columns_.size());
  std::vector<std::size_t> poor, rich;
  for (std::size_t i = 0; i < share.size(); ++i) {
    share[i] *= count / area_;
    (share[i] < 1 ? poor : rich).push_back(i);
  }
  while (!poor.empty() && !rich.empty()) {
    const std::size_t low = poor.back(), high = rich.back();
    poor.pop_back();
    columns_[low].keep = static_cast<float>(share[low]);
    columns_[low].alias = columns_[high].triangle;
    share[high] -= 1 - share[low];
    if (share[high] < 1) {
      rich.pop_back();
      poor.push_back(high);
    }
  }
}

std::pair<uint32_t, Vec2> AreaSampler::sample(Vec2 u) const {
  const double scaled = u.x * static_cast<double>(columns_.size());
  const std::size_t index = std::min(static_cast<std::size_t>(scaled), columns_.size() - 1);
  const Column& column = columns_[index];
  double rest = scaled - static_cast<double>(index);
  const double keep = column.keep;
  const bool own = rest < keep;
  rest = own ? rest / keep : (rest - keep) / (1 - keep);
  // Square root warping of the unit square onto the triangle.
  const double root = std::sqrt(std::clamp(rest, 0.0, 1.0));
  return {own ? column.triangle : column.alias, {root * (1 - u.y), root * u.y}};
}

}  // namespace alabaster
