#include "core/user_cache.h"

#include <cstdlib>

namespace alabaster {

namespace fs = std::filesystem;

fs::path user_cache_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache == '/') return fs::path(cache) / "alabaster";
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return fs::path(home) / ".cache" / "alabaster";
  return fs::temp_directory_path() / "alabaster";
}

}  // namespace alabaster
