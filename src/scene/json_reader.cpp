#include "scene/json_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/error.h"

namespace alabaster {

using nlohmann::json;

namespace {

/// Readers of JSON recurse; a file of nothing but brackets must not exhaust the stack.
bool nested_deeper_than(std::string_view text, int limit) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > limit) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

}  // namespace

json parse_json(const std::string& file, std::string_view text) {
  if (nested_deeper_than(text, 200))
    throw InputError(file, "is nested more than 200 levels deep; flatten it");
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    const std::size_t end = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
    const std::string_view before = text.substr(0, end);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t start = before.rfind('\n');
    const std::size_t column = end - (start == std::string_view::npos ? 0 : start + 1) + 1;
    const std::string what = error.what();
    // "[json.exception.parse_error.101] parse error at line 1, column 2: DETAIL": the place is ours already.
    const std::size_t detail = what.find(": ");
    throw InputError(file, fmt::format("line {}, column {}", line, column),
                     "is not valid JSON: " + (detail == std::string::npos ? what : what.substr(detail + 2)));
  } catch (const json::exception& error) {
    throw InputError(file, std::string("is not usable JSON: ") + error.what());
  }
}

namespace {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

const char* type_name(const json& value) {
  switch (value.type()) {
    case json::value_t::null:
      return "null";
    case json::value_t::object:
      return "an object";
    case json::value_t::array:
      return "an array";
    case json::value_t::string:
      return "a string";
    case json::value_t::boolean:
      return "true or false";
    default:
      return "a number";
  }
}

std::string range_text(double low, double high) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (low == -infinity) return fmt::format("at most {}", high);
  if (high == infinity) return fmt::format("at least {}", low);
  return fmt::format("between {} and {}", low, high);
}

}  // namespace

std::optional<std::string> nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  std::optional<std::string> best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 2) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) best = candidate, best_distance = distance;
  }
  return best;
}

std::string suggestion(const std::string& name, const std::vector<std::string>& candidates) {
  if (const auto nearest = nearest_name(name, candidates)) return "; did you mean '" + *nearest + "'?";
  if (candidates.empty()) return "; there are none";
  return fmt::format("; known are {}", fmt::join(candidates, ", "));
}

JsonObject::JsonObject(const json& value, const std::string& file, std::string place)
    : value_(value), file_(file), place_(std::move(place)) {
  if (!value.is_object()) fail(std::string("is ") + type_name(value) + "; it must be an object { }");
}

bool JsonObject::has(const std::string& key) const {
  return value_.contains(key);
}

bool JsonObject::is_string(const std::string& key) const {
  const auto it = value_.find(key);
  return it != value_.end() && it->is_string();
}

std::string JsonObject::place_of(const std::string& key) const {
  return place_.empty() ? key : place_ + "." + key;
}

void JsonObject::fail(const std::string& key, const std::string& problem) const {
  throw InputError(file_, place_of(key), problem);
}

void JsonObject::fail(const std::string& problem) const {
  if (place_.empty()) throw InputError(file_, problem);
  throw InputError(file_, place_, problem);
}

const json* JsonObject::find(const std::string& key) {
  known_.insert(key);
  const auto it = value_.find(key);
  return it == value_.end() ? nullptr : &*it;
}

std::optional<double> JsonObject::number(const std::string& key, double low, double high) {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_number())
    fail(key, std::string("is ") + type_name(*value) + "; it must be a number " + range_text(low, high));
  const double result = value->get<double>();
  if (!(result >= low && result <= high))
    fail(key, fmt::format("is {}; it must be {}", result, range_text(low, high)));
  return result;
}

std::optional<bool> JsonObject::boolean(const std::string& key) {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_boolean()) fail(key, std::string("is ") + type_name(*value) + "; it must be true or false");
  return value->get<bool>();
}

std::optional<std::string> JsonObject::string(const std::string& key) {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_string()) fail(key, std::string("is ") + type_name(*value) + "; it must be a string");
  return value->get<std::string>();
}

std::optional<Vec3> JsonObject::vector(const std::string& key) {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  Vec3 result{0};
  bool good = value->is_array() && value->size() == 3;
  for (int i = 0; good && i < 3; ++i) {
    const json& element = (*value)[static_cast<std::size_t>(i)];
    good = element.is_number();
    if (good) result[i] = element.get<double>();
  }
  if (!good) fail(key, "must be three numbers [x, y, z]");
  return result;
}

std::optional<Rgb> JsonObject::rgb(const std::string& key, double low, double high) {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_number()) return Rgb(*number(key, low, high));
  const auto triple = value->is_array() ? vector(key) : std::nullopt;
  if (!triple) fail(key, std::string("is ") + type_name(*value) + "; it must be a number or three [r, g, b]");
  for (int i = 0; i < 3; ++i)
    if (!((*triple)[i] >= low && (*triple)[i] <= high))
      fail(key, fmt::format("has {}; each channel must be {}", (*triple)[i], range_text(low, high)));
  return Rgb(triple->x, triple->y, triple->z);
}

std::optional<JsonObject> JsonObject::object(const std::string& key) {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  return JsonObject(*value, file_, place_of(key));
}

std::vector<std::pair<const json*, std::string>> JsonObject::array(const std::string& key) {
  std::vector<std::pair<const json*, std::string>> elements;
  const json* value = find(key);
  if (value == nullptr) return elements;
  if (!value->is_array()) fail(key, std::string("is ") + type_name(*value) + "; it must be an array [ ]");
  for (std::size_t i = 0; i < value->size(); ++i)
    elements.emplace_back(&(*value)[i], fmt::format("{}[{}]", place_of(key), i));
  return elements;
}

std::vector<std::pair<std::string, const json*>> JsonObject::members() {
  std::vector<std::pair<std::string, const json*>> all;
  for (const auto& [key, value] : value_.items()) {
    known_.insert(key);
    all.emplace_back(key, &value);
  }
  return all;
}

void JsonObject::finish() const {
  for (const auto& [key, value] : value_.items()) {
    if (known_.count(key) > 0) continue;
    fail(key, "is not a known key" + suggestion(key, {known_.begin(), known_.end()}));
  }
}

}  // namespace alabaster
