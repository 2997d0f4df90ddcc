#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/rgb.h"
#include "core/vec.h"

namespace alabaster {

/// Parses JSON; a syntax error leaves as InputError with file, line and column.
nlohmann::json parse_json(const std::string& file, std::string_view text);

/// The candidate most like `name` (Levenshtein), nothing when none is close enough to be a slip.
std::optional<std::string> nearest_name(const std::string& name, const std::vector<std::string>& candidates);
/// "; did you mean 'x'?", else "; known are a, b, c".
std::string suggestion(const std::string& name, const std::vector<std::string>& candidates);

/// One JSON object read key by key. Every reader remembers its key; finish() refuses keys that nobody asked
/// for. All errors are InputErrors that name the file and the place ("lights[2].radius").
class JsonObject {
 public:
  /// Throws when `value` is no object. `value` and `file` must outlive the reader.
  JsonObject(const nlohmann::json& value, const std::string& file, std::string place);

  bool has(const std::string& key) const;
  std::optional<double> number(const std::string& key, double low, double high);
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::string> string(const std::string& key);
  std::optional<Vec3> vector(const std::string& key);
  /// Three numbers or one for all channels, each within [low, high].
  std::optional<Rgb> rgb(const std::string& key, double low, double high);
  std::optional<JsonObject> object(const std::string& key);
  /// The elements of an array with their places.
  std::vector<std::pair<const nlohmann::json*, std::string>> array(const std::string& key);
  /// Every member as (key, value, place); marks all keys as known.
  std::vector<std::pair<std::string, const nlohmann::json*>> members();

  bool is_string(const std::string& key) const;
  /// Throws "PLACE.KEY: PROBLEM".
  [[noreturn]] void fail(const std::string& key, const std::string& problem) const;
  [[noreturn]] void fail(const std::string& problem) const;
  std::string place_of(const std::string& key) const;
  /// Throws when the object has a key that was never asked for, naming the nearest known one.
  void finish() const;

 private:
  const nlohmann::json* find(const std::string& key);

  const nlohmann::json& value_;
  const std::string& file_;
  std::string place_;
  std::set<std::string> known_;
};

}  // namespace alabaster
