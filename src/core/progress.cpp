#include "core/progress.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "core/parallel.h"

namespace alabaster {

namespace {

spdlog::logger& logger() {
  static const std::shared_ptr<spdlog::logger> instance = [] {
    auto made =
        std::make_shared<spdlog::logger>("alabaster", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    made->set_pattern("%n: %v");
    return made;
  }();
  return *instance;
}

}  // namespace

void say(const std::string& text) {
  logger().info(text);
}
void warn(const std::string& text) {
  logger().warn("warning: {}", text);
}
void set_quiet(bool quiet) {
  logger().set_level(quiet ? spdlog::level::warn : spdlog::level::info);
}

std::string format_duration(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{:.1f} s", seconds);
}

Progress::Progress(std::string label)
    : label_(std::move(label)), start_(wall_seconds()), enabled_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void Progress::update(double fraction, const std::string& note) {
  if (!enabled_) return;
  const double now = wall_seconds();
  if (now - last_ < 0.2) return;
  last_ = now;
  drawn_ = true;
  const double elapsed = now - start_;
  const std::string left = fraction > 0.01 && elapsed > 0.5
                               ? ", " + format_duration(elapsed * (1 - fraction) / fraction) + " left"
                               : "";
  fmt::print(stderr, "\r\033[K{} {:3.0f} % {}{}", label_, 100 * fraction, note, left);
  std::fflush(stderr);
}

}  // namespace alabaster
