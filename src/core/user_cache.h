#pragma once

#include <filesystem>

namespace alabaster {

/// Where results that are dear to make are kept between runs: $XDG_CACHE_HOME/alabaster, else
/// ~/.cache/alabaster, else a folder of the system's for temporary files. It need not exist.
std::filesystem::path user_cache_folder();

}  // namespace alabaster
