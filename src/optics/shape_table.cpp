#include "optics/shape_table.h"

#include <cstring>

#include "core/atomic_file.h"
#include "core/error.h"
#include "optics/table_archive.h"

namespace alabaster {

namespace {

constexpr char magic[8] = {'A', 'L', 'A', 'B', 'S', 'H', 'A', 'P'};

template <typename Archive, typename Table>
void transfer(Archive& archive, Table& table) {
  archive.field(table.g);
  archive.field(table.eta);
  archive.field(table.photons);
  archive.field(table.collisions);
  archive.field(table.seed);
  archive.field(table.provenance);
  for (auto& family : table.log2_factor) archive.field(family);
}

}  // namespace

std::string encode_shape_table(const ShapeTable& table) {
  TableWriter writer;
  writer.raw(magic, sizeof magic);
  writer.field(ShapeTable::version);
  transfer(writer, table);
  writer.field(fnv1a(writer.bytes()));
  return std::move(writer.bytes());
}

ShapeTable decode_shape_table(std::span<const char> bytes, const std::string& name) {
  if (bytes.size() < sizeof magic || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
    throw InputError(name, "not a table of shapes of Alabaster");
  TableReader reader(bytes, name);
  char found[sizeof magic];
  uint32_t version = 0;
  reader.raw(found, sizeof found);
  reader.field(version);
  if (version != ShapeTable::version)
    throw InputError(name, "table of shapes of version " + std::to_string(version) +
                               ", this program reads version " + std::to_string(ShapeTable::version) +
                               "; bake it again");
  ShapeTable table;
  transfer(reader, table);
  uint64_t checksum = 0;
  reader.field(checksum);
  if (reader.left() != 0 || checksum != fnv1a(bytes.first(bytes.size() - sizeof checksum)))
    throw InputError(name, "the table of shapes was altered (its checksum does not match); bake it again");
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
