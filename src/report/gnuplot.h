#pragma once

#include <filesystem>
#include <string>

namespace alabaster {

/// Runs gnuplot on `script` (without terminal and output, which are set here) and leaves an SVG in `file`.
/// Throws InputError when gnuplot is not installed or refuses the script.
void plot_svg(const std::filesystem::path& file, const std::string& script, int width = 720,
              int height = 480);

}  // namespace alabaster
