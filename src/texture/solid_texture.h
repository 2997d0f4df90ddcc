#pragma once

#include <functional>

#include "core/rgb.h"
#include "geometry/mesh.h"
#include "texture/patterns.h"
#include "texture/texture.h"

namespace alabaster {

/// A value at every point of space, m: what a block of the material looks like before it is carved.
using SolidPattern = std::function<Rgb(const Vec3& p)>;

/// Slabs of the two tones across `axis` (need not be unit), light first, each half a period thick, m.
SolidPattern solid_stripes(const Vec3& axis, double period, const Tones& tones = {});
/// Cubes of the two tones, side m.
SolidPattern solid_checker(double side, const Tones& tones = {});

/// Stone: clouds of two body tones, and veins along the warped zeros of a noise field.
struct StoneParameters {
  Rgb body{0.97}, cloud{0.95}, vein{0.6};
  double scale = 1;          // m, size of the clouds; veins lie about this far apart
  double vein_width = 0.06;  // of the scale
  double vein_strength = 0.85;
  double warp = 0.8;  // how much veins wander, of the scale
  uint64_t seed = 1;
};
SolidPattern solid_stone(const StoneParameters& parameters);

/// The texture that shows a solid pattern on a mesh: each texel that the UVs touch is the mean over its
/// footprint of 3 x 3 points on the triangle it lies on (its plane continued up to two texels beyond a
/// chart's border). Texels farther out get `outside`; nobody should read them. A is 1 on charts and 0
/// elsewhere.
TexelArray bake_solid(const TriangleMesh& mesh, int width, int height, const SolidPattern& pattern,
                      const Rgb& outside = Rgb(0.5));

}  // namespace alabaster
