#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace alabaster {

/// Calls write(temporary) with a path beside `target`, then renames it to `target`: a reader sees the old
/// file or the whole new one, never half. The temporary is removed when `write` throws. Missing parent
/// folders are made. Throws InputError when the folder cannot be written.
void write_file_atomically(const std::filesystem::path& target,
                           const std::function<void(const std::filesystem::path& temporary)>& write);
void write_text_atomically(const std::filesystem::path& target, std::string_view text);

/// The whole of a file. Throws InputError when it cannot be read.
std::string read_text(const std::filesystem::path& path);

/// Makes the folder if need be. Throws InputError when no file can be put there, which a run should say
/// before it begins; `named` is what the user called the place.
void require_folder(const std::filesystem::path& folder, const std::filesystem::path& named);

}  // namespace alabaster
