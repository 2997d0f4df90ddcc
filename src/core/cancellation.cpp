#include "core/cancellation.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>

namespace alabaster {

namespace {

std::atomic<bool> requested{false};
std::atomic<const char*> parting_line{nullptr};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<const char*>::is_always_lock_free,
              "used in a signal handler");

void on_signal(int signal) {
  if (const char* line = parting_line.load(std::memory_order_relaxed)) {
    [[maybe_unused]] const auto written = write(STDERR_FILENO, line, std::strlen(line));
    _exit(130);
  }
  if (requested.exchange(true)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

void install_cancellation_handler() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}
bool cancellation_requested() {
  return requested.load(std::memory_order_relaxed);
}
void request_cancellation() {
  requested = true;
}
void clear_cancellation() {
  requested = false;
}

PromptExit::PromptExit(const char* line) {
  parting_line.store(line, std::memory_order_relaxed);
}
PromptExit::~PromptExit() {
  parting_line.store(nullptr, std::memory_order_relaxed);
}

}  // namespace alabaster
