#include "support/paths.h"

#include <stdlib.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

std::filesystem::path source_dir() {
  return ALABASTER_SOURCE_DIR;
}
std::filesystem::path program() {
  return ALABASTER_PROGRAM;
}

std::optional<std::filesystem::path> extra_dir() {
  const char* value = std::getenv("ALABASTER_EXTRA");
  if (value == nullptr || *value == 0) return std::nullopt;
  return std::filesystem::path(value);
}

ScratchFolder::ScratchFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "alabaster-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no scratch folder");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}
