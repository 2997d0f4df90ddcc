#pragma once

#include <filesystem>
#include <optional>

/// The checkout, and the program under test.
std::filesystem::path source_dir();
std::filesystem::path program();
/// The folder of models from outside the repository (environment variable ALABASTER_EXTRA), if there is one.
/// Tests that need it call this, say SKIPPED and return when it is absent.
std::optional<std::filesystem::path> extra_dir();
/// A fresh folder for one test's files, removed when the object dies.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};
