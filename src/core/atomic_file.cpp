#include "core/atomic_file.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

#include "core/error.h"

namespace alabaster {

namespace fs = std::filesystem;

void write_file_atomically(const fs::path& target, const std::function<void(const fs::path&)>& write) {
  static std::atomic<unsigned> serial{0};
  std::error_code error;
  if (fs::is_directory(target, error)) throw InputError(target.string(), "is a folder; name a file to write");
  if (target.has_parent_path()) {
    fs::create_directories(target.parent_path(), error);
    if (error) throw InputError(target.string(), "its folder cannot be made: " + error.message());
  }
  // The ending is kept: libraries choose the format by it.
  fs::path temporary = target;
  temporary.replace_filename("." + target.stem().string() + ".part" + std::to_string(getpid()) + "-" +
                             std::to_string(serial++) + target.extension().string());
  try {
    write(temporary);
    fs::rename(temporary, target, error);
    if (error) throw InputError(target.string(), "cannot be written: " + error.message());
  } catch (...) {
    fs::remove(temporary, error);
    throw;
  }
}

void require_folder(const fs::path& folder, const fs::path& named) {
  const fs::path place = folder.empty() ? fs::path(".") : folder;
  std::error_code error;
  fs::create_directories(place, error);
  if (error || !fs::is_directory(place, error) || access(place.c_str(), W_OK) != 0)
    throw InputError(named.string(), folder == named
                                         ? "is no folder that can be written; choose another with -o"
                                         : "its folder cannot be written; choose another with -o");
}

void write_text_atomically(const fs::path& target, std::string_view text) {
  write_file_atomically(target, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    out.close();
    if (!out) throw InputError(target.string(), std::string("cannot be written: ") + std::strerror(errno));
  });
}

std::string read_text(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path.string(), "is a folder, not a file");
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf() || in.peek() == EOF))
    throw InputError(path.string(), "cannot be read; check the name and its permissions");
  return std::move(text).str();
}

}  // namespace alabaster
