#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
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

/// Reads them again. Throws InputError when the bytes end too soon.
class TableReader {
 public:
  TableReader(std::span<const char> bytes, const std::string& name) : rest_(bytes), name_(name) {}

  void raw(void* data, std::size_t size) {
    if (size > rest_.size()) throw InputError(name_, "the profile table is truncated; bake it again");
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
    if (count > rest_.size() / element)
      throw InputError(name_, "the profile table is truncated; bake it again");
    return count;
  }

  std::span<const char> rest_;
  const std::string& name_;
};

}  // namespace alabaster
