#include "core/cancellation.h"

#include <atomic>
#include <csignal>

namespace alabaster {

namespace {

std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

void on_signal(int signal) {
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

}  // namespace alabaster
