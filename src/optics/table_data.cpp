#include "optics/table_data.h"

#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "optics/radial_bins.h"
#include "optics/table_archive.h"

namespace alabaster {

namespace {

constexpr TableFrame frame{{'A', 'L', 'A', 'B', 'P', 'R', 'O', 'F'}, TableData::version, "profile table"};

template <typename Archive, typename Table>
void transfer(Archive& archive, Table& table) {
  auto view = static_cast<uint32_t>(table.view);
  archive.field(view);
  if constexpr (!std::is_const_v<Table>) table.view = static_cast<TableView>(view);
  archive.field(table.g);
  archive.field(table.eta);
  archive.field(table.photons);
  archive.field(table.collisions);
  archive.field(table.seed);
  archive.field(table.truncated);
  archive.field(table.provenance);
  archive.field(table.reflectance_over_albedo);
  archive.field(table.reflectance_standard_error);
  archive.field(table.log2_density);
  archive.field(table.mixture);
  archive.field(table.mixture_error);
}

}  // namespace

double AlbedoRows::position(double albedo) {
  const double root = std::sqrt(1 - albedo);
  return (count - 1) / length * (std::log2(1 + root / knee) + linear * root);
}

double AlbedoRows::albedo(double position) {
  const double target = std::clamp(position / (count - 1), 0.0, 1.0) * length;
  if (target == length) return 0;
  // s is concave in r, so Newton's steps from r = 0 rise to the solution and stop there.
  double root = 0;
  for (int step = 0; step < 100; ++step) {
    const double error = target - std::log2(1 + root / knee) - linear * root;
    const double next = std::min(1.0, root + error / (1.4426950408889634 / (knee + root) + linear));
    if (!(next > root)) break;
    root = next;
  }
  return 1 - root * root;
}

std::string encode_table(const TableData& table) {
  return encode_framed(frame, [&](TableWriter& writer) { transfer(writer, table); });
}

TableData decode_table(std::span<const char> bytes, const std::string& name) {
  TableData table;
  decode_framed(frame, bytes, name, [&](TableReader& reader) { transfer(reader, table); });
  const std::size_t rows = AlbedoRows::count;
  if (table.reflectance_over_albedo.size() != rows || table.reflectance_standard_error.size() != rows ||
      table.log2_density.size() != rows * RadialBins::inner ||
      table.mixture.size() != rows * TableData::mixture_size)
    throw InputError(name, "the profile table has the wrong number of rows; bake it again");
  return table;
}

void write_table(const std::filesystem::path& path, const TableData& table) {
  write_text_atomically(path, encode_table(table));
}

TableData read_table(const std::filesystem::path& path) {
  const std::string bytes = read_text(path);
  return decode_table(bytes, path.string());
}

}  // namespace alabaster
