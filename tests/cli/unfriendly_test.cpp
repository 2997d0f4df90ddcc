// What a hurried or a hostile user types: one line that says what is wrong, an exit code, no crash, no file.

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <limits>

#include "cli/tiny_scene.h"
#include "support/paths.h"
#include "support/run_program.h"

namespace fs = std::filesystem;
using alabaster::Vec3;

namespace {

int files_in(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("numbers out of range, folders that are none and names too long are refused at once") {
  const ScratchFolder folder;
  write_text(folder / "file", "text");
  const int before = files_in(folder.path());
  struct Case {
    std::vector<std::string> arguments;
    std::string says;
  };
  const std::vector<Case> cases{
      {{"frobnicate"}, "no such subcommand"},
      {{"bake", "--photons", "-1", "-o", "t"}, "--photons"},
      {{"bake", "--photons", "0", "-o", "t"}, "--photons"},
      {{"bake", "--g", "nan", "-o", "t"}, "'nan' is not a number from -0.99 to 0.99"},
      {{"bake", "--eta", "inf", "-o", "t"}, "'inf' is not a number from 1 to 4"},
      {{"profile", "--alpha", "nan"}, "'nan' is not a number from 0 to 1"},
      {{"profile", "--eta", "nan"}, "--eta"},
      {{"generate", "blob", "--triangles", "-1"}, "not in range 1 to 20000000"},
      {{"validate", "-o", "v", "--threads", "-3"}, "--threads"},
      {{"validate", "-o", "v", "--reference-noise", "nan"}, "--reference-noise"},
      {{"validate", "-o", "file"}, "file: is no folder that can be written"},
      {{"validate", "-o", "/proc/none"}, "/proc/none: is no folder"},
      {{"chart", "-o", "file/below"}, "file/below: is no folder"},
      {{"chart", "-o", "c", "--threads", "-1"}, "--threads"},
      {{"render", "ball.glb", "-o", std::string(300, 'a') + ".exr"}, "name is too long"},
      {{"compare", "a.exr", "b.exr", "--diff", "d.jpg"}, "must end in .png"},
      {{"info", std::string(300, 'a') + ".glb"}, "cannot be read"},
  };
  ProgramOptions options;
  options.working_folder = folder.path();
  for (const Case& c : cases) {
    const ProgramRun run = run_program(c.arguments, options);
    INFO(c.arguments[0] << " " << c.arguments.back() << ": " << run.exit_code << ", " << run.err);
    CHECK((run.exit_code == 1 || run.exit_code == 2));
    CHECK(run.err.find(c.says) != std::string::npos);
    CHECK(run.error_lines() <= 2);  // a wrong option points to --help
    CHECK(run.out.empty());
  }
  CHECK(files_in(folder.path()) == before);
}

TEST_CASE("a model of no sensible size is refused") {
  const ScratchFolder folder;
  for (const double scale : {1e-30, 1e30}) {
    alabaster::TriangleMesh mesh = alabaster::make_sphere(1, 16);
    for (Vec3& p : mesh.positions) p *= scale;
    mesh.materials.assign(mesh.triangle_count(), 0);
    alabaster::ExportScene scene;
    scene.objects = {{"ball", &mesh}};
    scene.materials.emplace_back();
    write_glb(folder / "ball.glb", scene);
    const ProgramRun run = run_program({"render", (folder / "ball.glb").string(), "-o",
                                        (folder / "out.exr").string(), "--size", "8x8", "--quiet"});
    INFO(run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.error_lines() == 1);
  }
}

TEST_CASE("Ctrl-C and SIGTERM end what simulates or generates at once, with one line and no file") {
  const ScratchFolder folder;
  const std::vector<std::vector<std::string>> commands{
      {"bake", "--quality", "full", "--g", "0.1", "-o", (folder / "t.table").string()},
      {"profile", "--photons", "100000000000"},
      {"chart", "--what", "geodesic", "-o", (folder / "chart").string()}};
  for (const auto& command : commands)
    for (const int signal : {SIGINT, SIGTERM}) {
      ProgramOptions options;
      // Before main() has installed its handler a signal ends any program, without a line.
      options.meanwhile = [&](pid_t child) {
        wait_until([&] { return kill(child, 0) != 0; }, 1.0);
        kill(child, signal);
      };
      const ProgramRun run = run_program(command, options);
      INFO(command[0] << ": " << run.err);
      CHECK(run.exit_code == 130);
      CHECK(run.err.find("alabaster: interrupted; ") != std::string::npos);
      CHECK_FALSE(fs::exists(folder / "t.table"));
      CHECK_FALSE(fs::exists(folder / "chart" / "chart.html"));
    }
}

TEST_CASE("chart refuses options that mean nothing for the study asked for") {
  const ScratchFolder folder;
  const ProgramRun run =
      run_program({"chart", "--what", "geodesic", "--scenes", "sphere_3", "-o", (folder / "out").string()});
  CHECK(run.exit_code == 1);
  CHECK(run.error_lines() == 1);
  CHECK(run.err.find("--scenes") != std::string::npos);
}
