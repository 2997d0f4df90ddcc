#pragma once

#include <string>

namespace alabaster {

/// One line of progress on standard error with an estimate of the time left, redrawn at most five times a
/// second. Silent when standard error is not a terminal. Not thread-safe.
class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();  // ends the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `fraction` of the work done, 0 to 1; `note` follows it ("16 spp").
  void update(double fraction, const std::string& note = {});

 private:
  std::string label_;
  double start_, last_ = 0;
  bool enabled_, drawn_ = false;
};

/// Warnings and remarks for the user, on standard error: "alabaster: TEXT". Thread-safe.
void say(const std::string& text);
void warn(const std::string& text);
/// Suppresses say(), not warn() (--quiet).
void set_quiet(bool quiet);

/// "2 h 05 min", "3 min 20 s", "4.2 s".
std::string format_duration(double seconds);

}  // namespace alabaster
