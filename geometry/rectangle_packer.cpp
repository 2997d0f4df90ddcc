#include "geometry/rectangle_packer.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <optional>

namespace alabaster {

namespace {

/// Origins at one scale, tallest first; nothing if they do not fit.
std::optional<std::vector<Vec2>> place_on_shelves(const std::vector<Vec2>& sizes,
                                                  const std::vector<std::size_t>& by_height, double scale,
                                                  double gutter) {
  std::vector<Vec2> origins(sizes.size());
  double x = gutter, shelf_top = gutter, shelf_height = 0;
  for (const std::size_t k : by_height) {
    const Vec2 size = scale * sizes[k];
    if (x + size.x + gutter > 1) {
      shelf_top += shelf_height + gutter;
      x = gutter, shelf_height = 0;
    }
    if (x + size.x + gutter > 1 || shelf_top + size.y + gutter > 1) return std::nullopt;
    origins[k] = {x, shelf_top};
    x += size.x + gutter;
    shelf_height = std::max(shelf_height, size.y);
  }
  return origins;
}

}  // namespace

RectanglePacking pack_rectangles(const std::vector<Vec2>& sizes, double gutter) {
  std::vector<std::size_t> by_height(sizes.size());
  std::iota(by_height.begin(), by_height.end(), std::size_t{0});
  std::stable_sort(by_height.begin(), by_height.end(),
                   [&](std::size_t a, std::size_t b) { return sizes[a].y > sizes[b].y; });
  double largest_side = 0;
  for (const Vec2& size : sizes) {
    assert(size.x > 0 && size.y > 0);
    largest_side = std::max({largest_side, size.x, size.y});
  }

  // Whether a scale fits is not quite monotonic, but the best of the bisection is always a scale that did
  // fit.
  double low = 0, high = 1 / largest_side;
  RectanglePacking best;
  for (int step = 0; step < 60; ++step) {
    const double scale = 0.5 * (low + high);
    if (auto origins = place_on_shelves(sizes, by_height, scale, gutter)) {
      best = {scale, std::move(*origins)};
      low = scale;
    } else {
      high = scale;
    }
  }
  assert(best.scale > 0 && "the gutters alone fill the square");
  return best;
}

}  // namespace alabaster
