#include "optics/shape_table.h"

#include "core/atomic_file.h"
#include "core/error.h"
#include "optics/table_archive.h"

namespace alabaster {

namespace {

constexpr TableFrame frame{{'A', 'L', 'A', 'B', 'S', 'H', 'A', 'P'}, ShapeTable::version, "table of shapes"};

template <typename Archive, typename Table>
void transfer(Archive& archive, Table& table) {
  archive.field(table.g);
  archive.field(table.eta);
  archive.field(table.photons);
  archive.field(table.collisions);
  archive.field(table.seed);
  archive.field(table.provenance);
  for (auto& family : table.log2_factor) archive.field(family);
  archive.field(table.aim);
}

}  // namespace

std::string encode_shape_table(const ShapeTable& table) {
  return encode_framed(frame, [&](TableWriter& writer) { transfer(writer, table); });
}

ShapeTable decode_shape_table(std::span<const char> bytes, const std::string& name) {
  ShapeTable table;
  decode_framed(frame, bytes, name, [&](TableReader& reader) { transfer(reader, table); });
  if (table.aim.size() != AimGrid::index(AimGrid::nodes, 0))
    throw InputError(name, "the table of shapes has the wrong size; bake it again");
  for (int f = 0; f < ShapeGrid::family_count; ++f) {
    const int nodes = ShapeGrid::nodes(static_cast<ShapeFamily>(f));
    if (table.log2_factor[static_cast<std::size_t>(f)].size() !=
        static_cast<std::size_t>(ShapeGrid::sizes * nodes * ShapeGrid::rows))
      throw InputError(name, "the table of shapes has the wrong size; bake it again");
  }
  return table;
}

void write_shape_table(const std::filesystem::path& path, const ShapeTable& table) {
  write_text_atomically(path, encode_shape_table(table));
}

ShapeTable read_shape_table(const std::filesystem::path& path) {
  const std::string bytes = read_text(path);
  return decode_shape_table(bytes, path.string());
}

}  // namespace alabaster
