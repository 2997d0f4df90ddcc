#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include "cli/tiny_scene.h"
#include "image/exr_file.h"
#include "support/paths.h"
#include "support/run_program.h"

namespace fs = std::filesystem;
using alabaster::ExrFile;
using alabaster::Image;
using alabaster::read_exr;

namespace {

bool same_channels(const Image& a, const Image& b) {
  if (a.width() != b.width() || a.height() != b.height() || a.channels() != b.channels()) return false;
  for (int c = 0; c < static_cast<int>(a.channels().size()); ++c)
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x)
        if (a.at(c, x, y) != b.at(c, x, y)) return false;
  return true;
}

bool all_finite(const Image& image) {
  for (int c = 0; c < static_cast<int>(image.channels().size()); ++c)
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x)
        if (!std::isfinite(image.at(c, x, y))) return false;
  return true;
}

int files_in(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("a scene file renders with its own defaults, which the command line overrides") {
  const ScratchFolder folder;
  const std::string scene = write_ball_scene(folder.path()).string(), out = (folder / "out.exr").string();
  ProgramRun run = run_program({"render", scene, "-o", out, "--png", (folder / "out.png").string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.empty());
  CHECK(run.err.find("out.exr: 24x16, 4 spp") != std::string::npos);
  CHECK(fs::file_size(folder / "out.png") > 100);
  ExrFile file = read_exr(out);
  CHECK(file.image.width() == 24);
  CHECK(file.image.find("variance.G") >= 0);
  CHECK(file.image.find("depth.Z") >= 0);
  CHECK(file.attributes.at("alabaster.seed") == "0");
  CHECK(file.attributes.count("alabaster.version") == 1);
  CHECK(file.image.at(3, 0, 0) == 0);  // transparent where the hidden environment is
  CHECK(file.image.at(3, 12, 8) == 1);
  CHECK(file.image.at(0, 12, 8) > 0);
  CHECK(all_finite(file.image));

  run = run_program({"render", scene, "-o", out, "--size", "10x8", "--spp", "2", "--seed", "7", "--quiet"});
  REQUIRE(run.exit_code == 0);
  CHECK(run.err.empty());
  file = read_exr(out);
  CHECK(file.image.width() == 10);
  CHECK(file.image.at(file.image.find("samples.Y"), 3, 3) == 2);
  CHECK(file.attributes.at("alabaster.seed") == "7");
}

TEST_CASE("a bare model renders: from any folder, by a relative path, through a link to the program") {
  const ScratchFolder folder;
  write_ball(folder.path());
  fs::create_directory(folder / "elsewhere");
  fs::create_symlink(program(), folder / "link");
  ProgramOptions options;
  options.working_folder = folder / "elsewhere";
  options.program = folder / "link";
  const ProgramRun run =
      run_program({"render", "../ball.glb", "-o", "deep/out.exr", "--size", "8x8", "--spp", "1"}, options);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.err.find("mean free path") != std::string::npos);  // says what it assumed
  CHECK(all_finite(read_exr(folder / "elsewhere/deep/out.exr").image));
}

TEST_CASE("the image does not depend on the threads, and a crop is part of the whole") {
  const ScratchFolder folder;
  const std::string scene = write_ball_scene(folder.path()).string();
  const auto render = [&](const char* name, std::vector<std::string> more) {
    const fs::path out = folder / name;
    std::vector<std::string> arguments{"render", scene, "-o", out.string(), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    REQUIRE(run_program(arguments).exit_code == 0);
    return read_exr(out).image;
  };
  const Image one = render("one.exr", {"--threads", "1"});
  CHECK(same_channels(one, render("two.exr", {"--threads", "2"})));
  CHECK(same_channels(one, render("three.exr", {"--threads", "3"})));
  const Image part = render("part.exr", {"--crop", "5,2,20,14"});
  REQUIRE(part.width() == 15);
  REQUIRE(part.height() == 12);
  for (int c = 0; c < static_cast<int>(part.channels().size()); ++c)
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 15; ++x) REQUIRE(part.at(c, x, y) == one.at(c, x + 5, y + 2));
}

TEST_CASE("wrong options end with code 1, one line, and no file") {
  const ScratchFolder folder;
  const std::string scene = write_ball_scene(folder.path()).string(), out = (folder / "out.exr").string();
  const int before = files_in(folder.path());
  const std::vector<std::vector<std::string>> wrong{
      {"--spp", "0"},
      {"--spp", "many"},
      {"--size", "512"},
      {"--size", "0x5"},
      {"--crop", "0,0,0,5"},
      {"--crop", "0,0,25,5"},
      {"--sampler", "halton"},
      {"--model", "magic"},
      {"--integrator", "planar"},
      {"--integrator", "nonsense"},
      {"--basis", "sphere"},
      {"--placement", "string"},
      {"--time", "-1"},
      {"--exposure", "nan"},
      {"--mean-free-path", "wide"},
      {"--g", "1"},
      {"--eta", "0.5"},
      {"--camera", "nobody"},
      {"--depth", "-1"},
      {"--turntable", "0"},
      {"--seed", "-1"},
      {"--png", "picture.jpg"},
      {"--subsurface-map", "missing.png"},
      {"--subsurface", "no_such_material"},
  };
  for (const std::vector<std::string>& options : wrong) {
    std::vector<std::string> arguments{"render", scene, "-o", out, "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramRun run = run_program(arguments);
    INFO(options[0] << " " << options[1] << ": " << run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.error_lines() == 1);
    CHECK(run.err.rfind("alabaster: ", 0) == 0);
    CHECK(run.out.empty());
    CHECK_FALSE(fs::exists(out));
  }
  CHECK(files_in(folder.path()) == before);
}

TEST_CASE("files that are missing, not scenes or cannot be written end with one line") {
  const ScratchFolder folder;
  const std::string scene = write_ball_scene(folder.path()).string(), out = (folder / "out.exr").string();
  const std::string text = write_text(folder / "text.json", "{ not json").string();
  const std::string key =
      write_text(folder / "key.json", R"({"version": 1, "model": "ball.glb", "wrong": 1})").string();
  const std::string option =
      write_text(
          folder / "option.json",
          R"({"version": 1, "model": "ball.glb", "environment": {"radiance": 1}, "integrator": {"sppp": 1}})")
          .string();
  const std::vector<std::vector<std::string>> wrong{{(folder / "missing.glb").string(), "-o", out},
                                                    {folder.path().string(), "-o", out},
                                                    {text, "-o", out},
                                                    {key, "-o", out},
                                                    {option, "-o", out},
                                                    {scene, "-o", (folder / "out.jpg").string()},
                                                    {scene, "-o", "/proc/no/out.exr"},
                                                    {scene, "-o", folder.path().string()}};
  for (std::vector<std::string> arguments : wrong) {
    arguments.insert(arguments.begin(), "render");
    arguments.push_back("--quiet");
    const ProgramRun run = run_program(arguments);
    INFO(arguments[1] << ": " << run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.error_lines() == 1);
  }
  CHECK(run_program({"render", key, "-o", out}).err.find("wrong") != std::string::npos);
  CHECK(run_program({"render", option, "-o", out}).err.find("sppp") != std::string::npos);
  CHECK(run_program({"render", scene}).exit_code == 2);  // no output named: usage
}

TEST_CASE("an output that is there already stays whole when a render fails") {
  const ScratchFolder folder;
  const std::string scene = write_ball_scene(folder.path()).string(), out = (folder / "out.exr").string();
  REQUIRE(run_program({"render", scene, "-o", out, "--quiet"}).exit_code == 0);
  const Image before = read_exr(out).image;
  CHECK(run_program({"render", scene, "-o", out, "--camera", "nobody"}).exit_code == 1);
  CHECK(same_channels(before, read_exr(out).image));
}

TEST_CASE("Ctrl-C leaves a valid image of what was done") {
  const ScratchFolder folder;
  const std::string scene = write_ball_scene(folder.path()).string(), out = (folder / "out.exr").string();
  // Too early, and there is nothing to leave: a busy machine or a sanitizer's program gets more time.
  ProgramRun run;
  for (int wait = 700; wait < 100000 && run.err.find("stopped early") == std::string::npos; wait *= 4) {
    ProgramOptions options;
    options.meanwhile = [wait](pid_t process) {
      std::this_thread::sleep_for(std::chrono::milliseconds(wait));
      kill(process, SIGINT);
    };
    run = run_program({"render", scene, "-o", out, "--spp", "10000000"}, options);
  }
  INFO(run.err);
  CHECK(run.exit_code == 130);
  CHECK(run.err.find("stopped early") != std::string::npos);
  const ExrFile file = read_exr(out);
  CHECK(all_finite(file.image));
  CHECK(file.attributes.at("alabaster.complete") == "no");
  CHECK(files_in(folder.path()) == 3);  // no temporaries
}

TEST_CASE("SIGTERM ends a program that is still loading at once, with one line") {
  const ScratchFolder folder;
  // A pipe that nobody writes to: the program waits in the midst of reading its scene.
  const std::string scene = (folder / "scene.json").string(), out = (folder / "out.exr").string();
  REQUIRE(mkfifo(scene.c_str(), 0600) == 0);
  int pipe = -1;
  ProgramOptions options;
  options.meanwhile = [&](pid_t process) {
    pipe = open(scene.c_str(), O_WRONLY);  // returns once the program has opened it
    kill(process, SIGTERM);
  };
  const ProgramRun run = run_program({"render", scene, "-o", out}, options);
  close(pipe);
  INFO(run.err);
  CHECK(run.exit_code == 130);
  CHECK(run.error_lines() == 1);
  CHECK(run.err.find("interrupted before the first sample") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(out));
}

TEST_CASE("a time limit ends a render in order, without asking for samples") {
  const ScratchFolder folder;
  const std::string scene = write_ball_scene(folder.path()).string(), out = (folder / "out.exr").string();
  const ProgramRun run = run_program({"render", scene, "-o", out, "--time", "0.4"});
  INFO(run.err);
  CHECK(run.exit_code == 0);
  const ExrFile file = read_exr(out);
  CHECK(all_finite(file.image));
  CHECK(std::stod(file.attributes.at("alabaster.seconds")) >= 0.4);
  CHECK(file.image.at(file.image.find("samples.Y"), 12, 8) > 4);  // the file's own count does not stop it
}

TEST_CASE("a turntable writes numbered images that differ") {
  const ScratchFolder folder;
  const std::string scene = write_ball_scene(folder.path()).string(), out = (folder / "out.exr").string();
  REQUIRE(run_program({"render", scene, "-o", out, "--turntable", "3", "--quiet", "--png",
                       (folder / "out.png").string()})
              .exit_code == 0);
  const Image first = read_exr(folder / "out.0001.exr").image;
  CHECK_FALSE(same_channels(first, read_exr(folder / "out.0002.exr").image));
  CHECK(fs::exists(folder / "out.0003.exr"));
  CHECK(fs::exists(folder / "out.0003.png"));
  CHECK_FALSE(fs::exists(folder / "out.exr"));
}
