#pragma once

#include <stdexcept>
#include <string>

namespace alabaster {

/// An error a user can cause and mend. what() is one line: "FILE: PLACE: PROBLEM; MEND".
/// Bugs are assertions, never this.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& line) : std::runtime_error(line) {}
  InputError(const std::string& file, const std::string& problem)
      : std::runtime_error(file + ": " + problem) {}
  InputError(const std::string& file, const std::string& place, const std::string& problem)
      : std::runtime_error(file + ": " + place + ": " + problem) {}
};

}  // namespace alabaster
