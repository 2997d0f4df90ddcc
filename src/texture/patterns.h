#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/rgb.h"
#include "texture/texture.h"

namespace alabaster {

/// The two values of a two-tone pattern: single-scattering albedos in [0, 1].
struct Tones {
  Rgb light{0.95}, dark{0.5};
};

/// A pattern over one tile, uv in [0, 1)^2 with v downwards; it repeats without a break in both directions.
using TilePattern = std::function<Rgb(Vec2 uv)>;

/// What make_pattern() knows:
///   stripes1   upright stripes, 10 periods per tile    stripes2  the same, 40 periods: four times finer
///   floral     ornament at several scales               escher    two interlocking figures that fill the
///   plane cork       natural, coloured                        logo      plain shapes in strong colours dots
///   round dots on a square grid, 10 across   checker   10 x 10 squares constant   the light tone
/// cork and logo have colours of their own; the others show the two tones.
const std::vector<std::string>& pattern_names();

/// The pattern as a function. Throws InputError, naming the known ones, if there is none of that name.
TilePattern tile_pattern(const std::string& name, const Tones& tones = {}, uint64_t seed = 1);

/// The pattern as size x size texels, each the mean of the pattern over it: single-scattering albedo in RGB,
/// 1 in A. Deterministic.
TexelArray make_pattern(const std::string& name, int size = 400, const Tones& tones = {}, uint64_t seed = 1);

}  // namespace alabaster
