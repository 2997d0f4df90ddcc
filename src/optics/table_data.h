#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace alabaster {

/// The albedos of a table's rows, equidistant in s = log2(1 + r / knee) + 8 r with r = sqrt(1 - alpha), from
/// alpha = 1 (row 0) to alpha = 0 (the last). Close to alpha = 1 that is proportional to r, in which A is
/// nearly linear; further away the diffusion length changes by the same factor from row to row; the linear
/// term keeps the rows dense towards alpha = 0.
struct AlbedoRows {
  static constexpr int count = 129;
  static constexpr double knee = 1.0 / 256;
  static constexpr double linear = 8;
  static constexpr double length = 8.005624549193878 + linear;  // s at alpha = 0; log2(257) + 8

  /// Position among the rows, 0 to count - 1. `albedo` in [0, 1].
  static double position(double albedo);
  static double albedo(double position);
};

/// Which outgoing light a table describes: all that leaves, or what leaves along the normal (in units in
/// which a Fresnel-weighted cosine lobe would make the two equal).
enum class TableView : uint32_t { all, normal };

/// What a baked table holds, and how it is written. Optical units.
struct TableData {
  static constexpr uint32_t version = 3;

  static constexpr int mixture_size = 5;

  TableView view = TableView::all;
  double g = 0, eta = 1;
  uint64_t photons = 0, collisions = 0, seed = 0;
  double truncated = 0;    // energy still inside after the last order tallied, at alpha = 1
  std::string provenance;  // one line for people
  std::vector<double> reflectance_over_albedo;     // [AlbedoRows::count] A(alpha) / alpha
  std::vector<double> reflectance_standard_error;  // of A / alpha
  std::vector<float>
      log2_density;  // [row][RadialBins::inner] log2 of 2 pi rho R / alpha at the bins' centres
  /// [row][component] {a_k / alpha, lambda_k} of five exponentials, rates in a lasting order.
  std::vector<std::array<double, 2>> mixture;
  double mixture_error = 0;  // mean |mixture / table - 1| over rows and distances
};

/// The file's bytes: magic, version, fields in order (little-endian), checksum.
std::string encode_table(const TableData& table);
/// Throws InputError naming `name` when the bytes are not a whole, unaltered table of this version.
TableData decode_table(std::span<const char> bytes, const std::string& name);

void write_table(const std::filesystem::path& path, const TableData& table);
TableData read_table(const std::filesystem::path& path);

}  // namespace alabaster
