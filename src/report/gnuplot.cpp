#include "report/gnuplot.h"

#include <fmt/format.h>

#include <csignal>
#include <cstdio>

#include "core/atomic_file.h"
#include "core/error.h"

namespace alabaster {

void plot_svg(const std::filesystem::path& file, const std::string& script, int width, int height) {
  write_file_atomically(file, [&](const std::filesystem::path& temporary) {
    // A name that gnuplot's quotes cannot misread.
    std::string quoted;
    for (const char c : temporary.string()) quoted += c == '\'' ? std::string("''") : std::string(1, c);
    const std::string whole = fmt::format(
        "set terminal svg size {},{} font 'sans-serif,12' background '#ffffff'\nset output '{}'\nset "
        "grid\n{}\n",
        width, height, quoted, script);
    const auto previous = std::signal(SIGPIPE, SIG_IGN);  // gnuplot may be missing or stop early
    FILE* pipe = popen("gnuplot", "w");
    bool good = pipe != nullptr && std::fwrite(whole.data(), 1, whole.size(), pipe) == whole.size();
    const int status = pipe != nullptr ? pclose(pipe) : -1;
    std::signal(SIGPIPE, previous);
    good = good && status == 0 && std::filesystem::exists(temporary);
    if (!good) throw InputError(file.string(), "gnuplot could not draw it; install the package gnuplot-nox");
  });
}

}  // namespace alabaster
