#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

// How baked tables are written and read. Little-endian.

namespace alabaster {

static_assert(std::endian::native == std::endian::little, "tables are written as they lie in memory");

/// The checksum of tables: FNV-1a (Fowler, Noll, Vo).
inline uint64_t fnv1a(std::span<const char> bytes) {
  uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;
  return hash;
}

/// Appends numbers and arrays as they lie in memory.
class TableWriter {
 public:
  void raw(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  void field(double value) { raw(&value, sizeof value); }
  void field(uint64_t value) { raw(&value, sizeof value); }
  void field(uint32_t value) { raw(&value, sizeof value); }
  void field(const std::string& text) {
    field(uint64_t{text.size()});
    raw(text.data(), text.size());
  }
  template <typename T>
  void field(const std::vector<T>& values) {
    field(uint64_t{values.size()});
    raw(values.data(), values.size() * sizeof(T));
  }
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

/// What encloses the fields of a kind of table: eight letters and a version before them, a checksum of all
/// that behind them.
struct TableFrame {
  char magic[8];
  uint32_t version;
  const char* kind;  // "profile table", for messages
};

/// Reads fields again. Throws InputError when the bytes end too soon.
class TableReader {
 public:
  TableReader(std::span<const char> bytes, const std::string& name, const char* kind)
      : rest_(bytes), name_(name), kind_(kind) {}

  void raw(void* data, std::size_t size) {
    if (size > rest_.size()) throw_truncated();
    if (size > 0) std::memcpy(data, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }
  void field(double& value) { raw(&value, sizeof value); }
  void field(uint64_t& value) { raw(&value, sizeof value); }
  void field(uint32_t& value) { raw(&value, sizeof value); }
  void field(std::string& text) {
    text.resize(length(1));
    raw(text.data(), text.size());
  }
  template <typename T>
  void field(std::vector<T>& values) {
    values.resize(length(sizeof(T)));
    raw(values.data(), values.size() * sizeof(T));
  }
  std::size_t left() const { return rest_.size(); }

 private:
  std::size_t length(std::size_t element) {
    uint64_t count = 0;
    field(count);
    if (count > rest_.size() / element) throw_truncated();
    return count;
  }
  [[noreturn]] void throw_truncated() const {
    throw InputError(name_, std::string("the ") + kind_ + " is truncated; bake it again");
  }

  std::span<const char> rest_;
  const std::string& name_;
  const char* kind_;
};

/// The bytes of a table whose fields `write_fields(TableWriter&)` writes.
template <typename WriteFields>
std::string encode_framed(const TableFrame& frame, const WriteFields& write_fields) {
  TableWriter writer;
  writer.raw(frame.magic, sizeof frame.magic);
  writer.field(frame.version);
  write_fields(writer);
  writer.field(fnv1a(writer.bytes()));
  return std::move(writer.bytes());
}

/// Has `read_fields(TableReader&)` read the fields of a table. Throws InputError naming `name` when the bytes
/// are not a whole, unaltered table of this kind and version.
template <typename ReadFields>
void decode_framed(const TableFrame& frame, std::span<const char> bytes, const std::string& name,
                   const ReadFields& read_fields) {
  const std::string kind = frame.kind;
  if (bytes.size() < sizeof frame.magic || std::memcmp(bytes.data(), frame.magic, sizeof frame.magic) != 0)
    throw InputError(name, "not a " + kind + " of Alabaster");
  TableReader reader(bytes.subspan(sizeof frame.magic), name, frame.kind);
  uint32_t version = 0;
  reader.field(version);
  if (version != frame.version)
    throw InputError(name, kind + " of version " + std::to_string(version) + ", this program reads version " +
                               std::to_string(frame.version) + "; bake it again");
  read_fields(reader);
  uint64_t checksum = 0;
  reader.field(checksum);
  if (reader.left() != 0 || checksum != fnv1a(bytes.first(bytes.size() - sizeof checksum)))
    throw InputError(name, "the " + kind + " was altered (its checksum does not match); bake it again");
}

}  // namespace alabaster
