#include "texture/patterns.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/parallel.h"
#include "texture/noise.h"

namespace alabaster {

namespace {

Rgb mix(const Rgb& a, const Rgb& b, double t) {
  return (1 - t) * a + t * b;
}

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Offset of p from `centre`, the short way around the tile.
Vec2 around(Vec2 p, Vec2 centre) {
  const Vec2 d = p - centre;
  return d - glm::floor(d + 0.5);
}

double fraction(double x) {
  return x - std::floor(x);
}

bool in_stripe(Vec2 uv, int periods) {
  return fraction(uv.x * periods) < 0.5;
}

bool in_dot(Vec2 uv) {
  const Vec2 p = 10.0 * uv;
  return glm::length(p - glm::floor(p) - 0.5) < 0.3;
}

bool in_checker(Vec2 uv) {
  const Vec2 cell = glm::floor(10.0 * uv);
  return std::fmod(cell.x + cell.y, 2.0) == 0;
}

/// Within a flower of `petals` petals and unit size: petals, a dark ring, a light heart.
bool in_flower(Vec2 p, int petals, double turn) {
  const double r = glm::length(p), angle = std::atan2(p.y, p.x) + turn;
  const double petal = std::abs(std::cos(petals * angle / 2));
  if (r < 0.16) return true;
  if (r < 0.24) return false;
  const bool vein = petal > 0.985 && r > 0.4 && r < 0.8;
  return r < 0.35 + 0.65 * std::pow(petal, 0.7) && !vein;
}

/// Tendrils around a point: curling arms that thin out towards their ends.
bool in_tendril(Vec2 p, int arms, double turn) {
  const double r = glm::length(p);
  if (r < 1.1 || r > 2.1) return false;
  const double angle = std::atan2(p.y, p.x) + turn + 0.9 * std::sin(2.4 * (r - 1.1));
  const double across = std::abs(std::sin(arms * angle / 2)) * 2 / arms * r;
  return across < 0.15 * (2.1 - r);
}

/// A ring of leaves between flower and tendrils' ends.
bool in_leaves(Vec2 p, int count, double turn) {
  const double r = glm::length(p), step = 2 * pi / count;
  const double angle = (fraction((std::atan2(p.y, p.x) + turn) / step) - 0.5) * step;
  const double along = (r - 1.55) / 0.42, across = angle * r / 0.2;
  return std::abs(along) < 1 && std::abs(across) < 1 - along * along && std::abs(across) > 0.12;
}

struct Flower {
  Vec2 centre;
  double size;
  int petals;
  double turn;
};

/// Flowers of three sizes, tendrils and leaves around the larger, wreaths of seeds, fine seeds between.
bool in_floral(Vec2 uv) {
  static const std::vector<Flower> flowers{{{0.5, 0.5}, 0.115, 8, 0.2},  {{0.0, 0.0}, 0.115, 8, -0.2},
                                           {{0.5, 0.0}, 0.085, 5, 0.7},  {{0.0, 0.5}, 0.085, 5, -0.4},
                                           {{0.25, 0.25}, 0.05, 6, 0.0}, {{0.75, 0.75}, 0.05, 6, 0.3},
                                           {{0.75, 0.25}, 0.06, 7, 0.1}, {{0.25, 0.75}, 0.06, 7, -0.1}};
  double nearest = 1e9;  // in units of the flower's size
  for (const Flower& flower : flowers) {
    const Vec2 p = around(uv, flower.centre) / flower.size;
    const double r = glm::length(p);
    nearest = std::min(nearest, r);
    if (in_flower(p, flower.petals, flower.turn)) return true;
    if (flower.size > 0.08) {
      if (in_tendril(p, flower.petals, flower.turn)) return true;
      if (in_leaves(p, flower.petals, flower.turn + 0.8 * pi / flower.petals)) return true;
    }
    const double seeds = 3 * flower.petals;
    const double along = (fraction(std::atan2(p.y, p.x) * seeds / (2 * pi)) - 0.5) * 2 * pi * r / seeds;
    const double wreath = flower.size > 0.08 ? 2.25 : 1.3;
    if (std::hypot(along, r - wreath) < 0.09) return true;
  }
  const Vec2 grid = 40.0 * uv, seed = grid - glm::floor(grid) - 0.5;
  return nearest > 2.5 && glm::length(seed) < 0.28;
}

/// Figures that interlock: the squares of a 6 x 6 board, their sides bent by shears that repeat from square
/// to square, light where row and column have the same parity; each has an eye and feathers in the other
/// tone.
bool in_escher(Vec2 uv) {
  Vec2 q = 6.0 * uv;  // an even number, so that the tones agree at the tile's border
  q.x += 0.16 * std::sin(2 * pi * q.y) + 0.07 * std::sin(4 * pi * q.y + 1.1);
  q.y += 0.15 * std::sin(2 * pi * q.x + 0.6) - 0.06 * std::cos(4 * pi * q.x);
  const Vec2 cell = glm::floor(q), inside = q - cell;
  const bool light = fraction((cell.x + cell.y) / 2) < 0.25;
  const bool eye = glm::length(inside - Vec2(0.75, 0.3)) < 0.07;
  const double wing = 0.55 + 0.1 * std::sin(2.2 * pi * inside.x);
  const bool rib = inside.x > 0.15 && inside.x < 0.65 && std::abs(inside.y - wing) < 0.03;
  const bool feather = inside.x > 0.18 && inside.x < 0.55 && inside.y > wing + 0.08 && inside.y < 0.85 &&
                       fraction(7 * inside.x) < 0.35;
  return light != (eye || rib || feather);
}

/// Pressed cork: grains of several browns, dark seams between some of them, pores.
Rgb cork(Vec2 uv, uint64_t seed) {
  const Vec2 warp{fractal_noise({8.0 * uv, 0.3}, 3, seed + 10, 8),
                  fractal_noise({8.0 * uv, 7.3}, 3, seed + 20, 8)};
  const CellularNoise grain = cellular_noise(18.0 * uv + 0.45 * warp, seed, 18);
  const CellularNoise pores = cellular_noise(32.0 * uv, seed + 1, 32);
  const double fine = fractal_noise({64.0 * uv, 0.7}, 2, seed + 30, 64);
  const Rgb pale(0.985, 0.945, 0.80), brown(0.955, 0.86, 0.60), bark(0.80, 0.58, 0.32);
  Rgb colour = mix(brown, pale, std::clamp(0.15 + 0.8 * grain.id + 0.25 * fine, 0.0, 1.0));
  const double seam = 1 - smooth_step(0.02, 0.16, grain.second - grain.nearest);
  colour = mix(colour, bark, 0.75 * seam * smooth_step(0.25, 0.6, grain.id));
  if (pores.id > 0.86) colour = mix(bark, colour, smooth_step(0.10, 0.28, pores.nearest));
  return colour;
}

/// A ring, a wedge-shaped letter A, bars and a corner disk on white.
Rgb logo(Vec2 uv) {
  const Rgb white(0.99, 0.99, 0.985), red(0.97, 0.35, 0.25), blue(0.30, 0.60, 0.96),
      yellow(0.985, 0.93, 0.30), black(0.35, 0.35, 0.38);
  const Vec2 p = around(uv, Vec2(0.5));
  const double r = glm::length(p);
  if (r > 0.33 && r < 0.41) {
    const double turn = fraction(std::atan2(p.y, p.x) / (2 * pi));
    return turn < 1.0 / 3 ? red : turn < 2.0 / 3 ? blue : yellow;
  }
  if (r < 0.30) {
    // The letter: two legs that meet at (0, -0.24), and a bar.
    const double y = p.y + 0.24, leg = std::abs(std::abs(p.x) - 0.36 * y);
    if (y > 0 && p.y < 0.19 && leg < 0.036) return black;
    if (p.y > 0.045 && p.y < 0.09 && std::abs(p.x) < 0.36 * y) return red;
    if (p.y > 0.115 && p.y < 0.16 && std::abs(p.x) < 0.36 * y - 0.05) return blue;
    return white;
  }
  if (glm::length(around(uv, {0, 0})) < 0.12) return yellow;
  if (glm::length(around(uv, {0, 0})) < 0.15) return blue;
  const bool band =
      r > 0.43 && (std::abs(around(uv, {0, 0.5}).y) < 0.02 || std::abs(around(uv, {0.5, 0}).x) < 0.02);
  return band ? red : white;
}

using Maker = std::function<TilePattern(const Tones&, uint64_t seed)>;

Maker two_tone(bool (*is_light)(Vec2)) {
  return [=](const Tones& tones, uint64_t) -> TilePattern {
    return [=](Vec2 uv) { return is_light(uv) ? tones.light : tones.dark; };
  };
}

const std::vector<std::pair<std::string, Maker>>& makers() {
  static const std::vector<std::pair<std::string, Maker>> list{
      {"stripes1", two_tone([](Vec2 uv) { return in_stripe(uv, 10); })},
      {"stripes2", two_tone([](Vec2 uv) { return in_stripe(uv, 40); })},
      {"floral", two_tone(in_floral)},
      {"escher", two_tone(in_escher)},
      {"cork", [](const Tones&, uint64_t seed) { return [=](Vec2 uv) { return cork(uv, seed); }; }},
      {"logo", [](const Tones&, uint64_t) { return logo; }},
      {"dots", two_tone(in_dot)},
      {"checker", two_tone(in_checker)},
      {"constant", two_tone([](Vec2) { return true; })}};
  return list;
}

}  // namespace

const std::vector<std::string>& pattern_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const auto& [name, maker] : makers()) result.push_back(name);
    return result;
  }();
  return names;
}

TilePattern tile_pattern(const std::string& name, const Tones& tones, uint64_t seed) {
  for (const auto& [known, maker] : makers())
    if (known == name) return maker(tones, seed);
  std::string list;
  for (const std::string& known : pattern_names()) list += (list.empty() ? "" : ", ") + known;
  throw InputError("pattern '" + name + "': not known; use one of " + list);
}

TexelArray make_pattern(const std::string& name, int size, const Tones& tones, uint64_t seed) {
  const TilePattern pattern = tile_pattern(name, tones, seed);
  const int points = name == "cork" ? 2 : 4;  // per texel and direction; cork is smooth, and slow
  TexelArray texels{size, size, {}};
  texels.texels.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  parallel_for(static_cast<std::size_t>(size), 4, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < size; ++x) {
        Rgb sum;
        for (int k = 0; k < points * points; ++k)
          sum += pattern(Vec2(x + (k % points + 0.5) / points, y + (k / points + 0.5) / points) /
                         static_cast<double>(size));
        sum /= points * points;
        texels.at(x, y) = Vec4f(sum.r, sum.g, sum.b, 1);
      }
  });
  return texels;
}

}  // namespace alabaster
