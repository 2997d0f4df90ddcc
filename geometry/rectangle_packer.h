#pragma once

#include <vector>

#include "core/vec.h"

namespace alabaster {

/// Where rectangles lie in the unit square once scaled by one common factor.
struct RectanglePacking {
  double scale = 0;           // UV units per unit of the sizes
  std::vector<Vec2> origins;  // top left corner of each, in the order given
};

/// Packs rectangles, unturned, into the unit square on shelves, as large as shelves allow, with `gutter` (UV
/// units) around each. Sizes must be positive; deterministic.
RectanglePacking pack_rectangles(const std::vector<Vec2>& sizes, double gutter);

}  // namespace alabaster
