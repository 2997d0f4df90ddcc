#include "report/chart.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "core/atomic_file.h"
#include "core/error.h"

extern char** environ;

namespace alabaster {

namespace fs = std::filesystem;

namespace {

// Okabe and Ito 2008; black last, for yellow is hard to see on white.
constexpr std::array<const char*, 7> colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                             "#E69F00", "#56B4E9", "#000000"};
constexpr std::array<int, 7> point_types{7, 5, 9, 13, 11, 3, 2};

/// A folder of its own for one run of gnuplot, removed with what it holds.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "alabaster-chart-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
      throw InputError(fs::temp_directory_path().string(), "no folder can be made there; set TMPDIR");
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + '"';
}

bool drawable(const Chart& chart, double x, double y) {
  return std::isfinite(x) && std::isfinite(y) && (!chart.log_x || x > 0) && (!chart.log_y || y > 0);
}

/// The lines "x y low high" of a series. Error bars stop short of 0 on a logarithmic axis.
std::vector<std::string> data_lines(const Chart& chart, const ChartSeries& series) {
  assert(series.x.size() == series.y.size());
  assert(series.y_error.empty() || series.y_error.size() == series.y.size());
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const double x = series.x[i], y = series.y[i];
    if (!drawable(chart, x, y)) continue;
    const double error = series.y_error.empty() || !std::isfinite(series.y_error[i]) ? 0 : series.y_error[i];
    const double low = chart.log_y ? std::max(y - error, 1e-3 * y) : y - error;
    lines.push_back(fmt::format("{:.10g} {:.10g} {:.10g} {:.10g}", x, y, low, y + error));
  }
  return lines;
}

std::string plot_clause(const ChartSeries& series, std::size_t block, std::size_t index) {
  const std::size_t style = index % colours.size(), dash = index / colours.size() + index % 3 + 1;
  const char* with = series.line && series.points ? "linespoints" : series.line ? "lines" : "points";
  const std::string look =
      series.emphasised
          ? fmt::format("lc rgb '#B0B0B0' lw 6 pt {} ps 0.9 dt 1", point_types[style])
          : fmt::format("lc rgb '{}' lw 1.8 pt {} ps 0.9 dt {}", colours[style], point_types[style], dash);
  std::string clause;
  if (!series.y_error.empty())  // below the points
    clause = fmt::format("$data{} using 1:2:3:4 with yerrorbars lc rgb '{}' lw 1 ps 0 notitle, ", block,
                         colours[style]);
  clause += fmt::format("$data{} using 1:2 with {} {} title {}", block, with, look, quoted(series.name));
  return clause;
}

void run_gnuplot(const fs::path& script, const fs::path& messages) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, messages.c_str(), O_WRONLY | O_CREAT | O_APPEND,
                                   0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::string program = "gnuplot", argument = script.string();
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const int failure = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0)
    throw InputError("gnuplot", std::string("cannot be started (") + std::strerror(failure) +
                                    "); charts need it: install the package gnuplot-nox");
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    throw InputError("gnuplot", "is not installed; charts need it: install the package gnuplot-nox");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::string text = read_text(messages);
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw InputError("gnuplot", "failed: " + text);
  }
}

std::string draw(const Chart& chart, const std::string& terminal) {
  const ScratchFolder folder;
  const fs::path script = folder.path() / "chart.gp", output = folder.path() / ("chart." + terminal);
  write_text_atomically(script, gnuplot_script(chart, terminal, output));
  run_gnuplot(script, folder.path() / "messages");
  return read_text(output);
}

std::string escaped_xml(const std::string& text) {
  std::string result;
  for (const char c : text)
    result += c == '<' ? "&lt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

}  // namespace

std::string gnuplot_script(const Chart& chart, const std::string& terminal, const fs::path& output) {
  std::string data, plots;
  std::size_t block = 0;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const auto lines = data_lines(chart, chart.series[i]);
    if (lines.empty()) continue;
    data += fmt::format("$data{} << end_of_data\n{}\nend_of_data\n", block, fmt::join(lines, "\n"));
    plots += (plots.empty() ? "" : ", \\\n     ") + plot_clause(chart.series[i], block, i);
    ++block;
  }
  if (plots.empty()) throw InputError("chart '" + chart.title + "'", "has no point that can be drawn");
  std::string script = data;
  script += terminal == "svg"
                ? fmt::format("set terminal svg size {},{} noenhanced background '#ffffff' font 'sans,14'\n",
                              chart.width, chart.height)
                : fmt::format("set terminal pngcairo size {},{} noenhanced font 'sans,11'\n", chart.width,
                              chart.height);
  script += "set output " + quoted(output.string()) + "\n";
  script += "set title " + quoted(chart.title) + "\nset xlabel " + quoted(chart.x_label) + "\nset ylabel " +
            quoted(chart.y_label) + "\n";
  if (chart.log_x) script += "set logscale x\nset format x '%.3g'\n";
  if (chart.log_y) script += "set logscale y\nset format y '%.3g'\n";
  script += "set grid lc rgb '#d0d0d0' lw 0.7\nset border 3\nset tics nomirror\nset key outside right top\n";
  return script + "plot " + plots + "\n";
}

std::string chart_svg(const Chart& chart) {
  std::string svg = draw(chart, "svg");
  // gnuplot names every picture "Gnuplot"; a screen reader should hear what it shows.
  const std::size_t begin = svg.find("<title>"), end = svg.find("</title>");
  if (begin != std::string::npos && end != std::string::npos)
    svg.replace(begin + 7, end - begin - 7, escaped_xml(chart.title));
  return svg;
}

void write_chart_svg(const fs::path& path, const Chart& chart) {
  write_text_atomically(path, chart_svg(chart));
}

void write_chart_png(const fs::path& path, const Chart& chart) {
  write_text_atomically(path, draw(chart, "png"));
}

void write_chart_files(const fs::path& stem, const Chart& chart) {
  write_chart_svg(stem.string() + ".svg", chart);
  write_chart_png(stem.string() + ".png", chart);
}

}  // namespace alabaster
