#pragma once

namespace alabaster {

/// Makes Ctrl-C (SIGINT) and SIGTERM ask for an orderly stop; a second Ctrl-C ends the process at once.
void install_cancellation_handler();
/// True once a stop was asked for. Long work polls it and leaves valid output of what is done.
bool cancellation_requested();
/// Asks for a stop as Ctrl-C does (tests).
void request_cancellation();
void clear_cancellation();

/// While one of these lives nothing is worth an orderly stop: the first Ctrl-C or SIGTERM prints `line` to
/// standard error and ends the process with exit code 130 at once. One at a time.
class PromptExit {
 public:
  /// `line` ends in a newline and outlives the object.
  explicit PromptExit(const char* line);
  ~PromptExit();
  PromptExit(const PromptExit&) = delete;
  PromptExit& operator=(const PromptExit&) = delete;
};

}  // namespace alabaster
