#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

/// What a run of the real program left.
struct ProgramRun {
  int exit_code = -1;  // 128 + signal when a signal ended it
  std::string out, err;
  /// Lines of `err`.
  int error_lines() const;
};

struct ProgramOptions {
  std::filesystem::path working_folder;                            // empty: this process's
  std::filesystem::path program;                                   // empty: the program under test
  std::vector<std::pair<std::string, std::string>> environment{};  // variables set beside this process's
  /// Called with the process id once the program runs, for instance to send it a signal.
  std::function<void(pid_t)> meanwhile;
};

/// Runs the program under test with these arguments and waits for it.
ProgramRun run_program(const std::vector<std::string>& arguments, const ProgramOptions& options = {});

/// Waits until `condition` holds, at most `seconds`; returns whether it did.
bool wait_until(const std::function<bool()>& condition, double seconds);
