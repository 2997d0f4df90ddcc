#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <string>

namespace alabaster {

/// Accepts numbers from `low` to `high`; CLI::Range lets what is not a number pass.
inline CLI::Validator between(double low, double high) {
  const std::string range = fmt::format("from {} to {}", low, high);
  const auto check = [=](const std::string& text) -> std::string {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc() && stop == end && value >= low && value <= high) return {};
    return fmt::format("'{}' is not a number {}", text, range);
  };
  return CLI::Validator(check, range);
}

}  // namespace alabaster
