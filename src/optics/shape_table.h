#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "optics/body_walk.h"
#include "optics/table_data.h"

namespace alabaster {

/// The bodies that were simulated. A slab's two sides are families of their own.
enum class ShapeFamily { ball, cavity, slab_near, slab_far };

/// Where the correction factors of the families are tabulated.
struct ShapeGrid {
  static constexpr int family_count = 4;
  /// Radii or thicknesses, mean free paths: 2^-2 .. 2^10, two to the octave.
  static constexpr int sizes = 25;
  static double size(int index) { return std::exp2(first_size_octave + 0.5 * index); }
  static constexpr double first_size_octave = -2;
  /// Distances as log2 of the ratio to the diameter (chords, ending at 1) or to the thickness (lateral), four
  /// to the octave.
  static constexpr int nodes_per_octave = 4;
  static constexpr int first_octave(ShapeFamily f) { return is_slab(f) ? -9 : -12; }
  static constexpr int nodes(ShapeFamily f) {
    return is_slab(f) ? 17 * nodes_per_octave + 1 : 12 * nodes_per_octave + 1;
  }
  /// Every fourth of AlbedoRows.
  static constexpr int row_stride = 4;
  static constexpr int rows = (AlbedoRows::count - 1) / row_stride + 1;
  static double albedo(int row) { return AlbedoRows::albedo(row * row_stride); }

  static constexpr bool is_slab(ShapeFamily f) {
    return f == ShapeFamily::slab_near || f == ShapeFamily::slab_far;
  }
};

/// Where the slope of light's aim is tabulated (aim_bake.h): distances from 2^-5 to 2^7 mean free paths, two
/// to the octave, at the albedos of ShapeGrid.
struct AimGrid {
  static constexpr int nodes = 25;
  static constexpr double first_octave = -5;
  static double position(double log2_distance) { return 2 * (log2_distance - first_octave); }
  static std::size_t index(int node, int row) {
    return static_cast<std::size_t>(node * ShapeGrid::rows + row);
  }
};

/// Correction factors over the half-space: log2 of S in the body over S of a half-space at the same chord.
struct ShapeTable {
  static constexpr uint32_t version = 2;
  static constexpr double step = 1.0 / 1024;  // of the stored integers, in log2

  double g = 0, eta = 1;
  uint64_t photons = 0, collisions = 0, seed = 0;
  std::string provenance;  // one line for people
  /// Per family [size][node][row].
  std::array<std::vector<int16_t>, ShapeGrid::family_count> log2_factor;

  std::vector<int16_t> aim;  // by AimGrid, in units of `step`

  static std::size_t index(ShapeFamily family, int size, int node, int row) {
    return static_cast<std::size_t>((size * ShapeGrid::nodes(family) + node) * ShapeGrid::rows + row);
  }
};

std::string encode_shape_table(const ShapeTable& table);
/// Throws InputError when the bytes are not a whole table of this version; `name` is for the message.
ShapeTable decode_shape_table(std::span<const char> bytes, const std::string& name);
void write_shape_table(const std::filesystem::path& path, const ShapeTable& table);
ShapeTable read_shape_table(const std::filesystem::path& path);

}  // namespace alabaster
