#include <catch2/catch.hpp>

#include "cli/tiny_scene.h"
#include "image/exr_file.h"
#include "support/paths.h"
#include "support/run_program.h"

namespace fs = std::filesystem;
using alabaster::read_exr;

TEST_CASE("a batch renders its jobs, with defaults, relative to its file") {
  const ScratchFolder folder;
  write_ball_scene(folder.path());
  const fs::path jobs = write_text(folder / "jobs.json", R"({
    "defaults": {"input": "scene.json", "spp": 2, "hide_environment": true},
    "jobs": [{"output": "a.exr", "seed": 3}, {"output": "sub/b.exr", "size": "9x7", "png": "sub/b.png"}]
  })");
  const ProgramRun run = run_program({"batch", jobs.string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.err.find("2 rendered, 0 skipped, 0 failed") != std::string::npos);
  CHECK(read_exr(folder / "a.exr").attributes.at("alabaster.seed") == "3");
  CHECK(read_exr(folder / "sub/b.exr").image.width() == 9);
  CHECK(fs::exists(folder / "sub/b.png"));
}

TEST_CASE("option -o sends a batch's outputs elsewhere") {
  const ScratchFolder folder;
  write_ball_scene(folder.path());
  const fs::path jobs =
      write_text(folder / "jobs.json", R"({"jobs": [{"input": "scene.json", "output": "a.exr", "spp": 1}]})");
  REQUIRE(run_program({"batch", jobs.string(), "-o", (folder / "there").string(), "--quiet"}).exit_code == 0);
  CHECK(fs::exists(folder / "there/a.exr"));
}

TEST_CASE("one failing job does not stop the rest, and the exit code tells") {
  const ScratchFolder folder;
  write_ball_scene(folder.path());
  const fs::path jobs = write_text(folder / "jobs.json", R"({
    "defaults": {"input": "scene.json", "spp": 1},
    "jobs": [{"output": "a.exr", "input": "missing.glb"}, {"output": "b.exr", "spp": 0}, {"output": "c.exr", "sppp": 3},
             {"seed": 4}, {"output": "d.exr"}, {"output": "d.exr"}, {"output": "e.exr", "camera": "nobody"}, 7]
  })");
  const ProgramRun run = run_program({"batch", jobs.string()});
  INFO(run.err);
  CHECK(run.exit_code == 1);
  CHECK(run.err.find("1 rendered, 0 skipped, 7 failed") != std::string::npos);
  CHECK(run.err.find("job 3: sppp") != std::string::npos);
  CHECK(fs::exists(folder / "d.exr"));
  CHECK_FALSE(fs::exists(folder / "b.exr"));
}

TEST_CASE("resuming skips finished outputs, and those only") {
  const ScratchFolder folder;
  write_ball_scene(folder.path());
  const auto write_jobs = [&](const char* seed) {
    return write_text(folder / "jobs.json", std::string(R"({"defaults": {"input": "scene.json", "spp": 1},
      "jobs": [{"output": "a.exr"}, {"output": "b.exr", "seed": )") +
                                                seed + "}, {\"output\": \"c.exr\"}]}");
  };
  const std::string jobs = write_jobs("1").string();
  REQUIRE(run_program({"batch", jobs, "--quiet"}).exit_code == 0);
  ProgramRun run = run_program({"batch", jobs, "--resume"});
  CHECK(run.err.find("0 rendered, 3 skipped, 0 failed") != std::string::npos);
  fs::remove(folder / "a.exr");
  write_text(folder / "c.exr", "half a file");
  write_jobs("2");  // another job than the one that made b.exr
  run = run_program({"batch", jobs, "--resume"});
  INFO(run.err);
  CHECK(run.err.find("3 rendered, 0 skipped, 0 failed") != std::string::npos);
}

TEST_CASE("a jobs file that is none ends with one line") {
  const ScratchFolder folder;
  for (const char* text :
       {"{", "[]", R"({"jobs": 3})", R"({"jobs": [], "default": {}})", R"({"jobs": [], "defaults": 1})"}) {
    const ProgramRun run = run_program({"batch", write_text(folder / "jobs.json", text).string()});
    INFO(text << ": " << run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.error_lines() == 1);
  }
  CHECK(run_program({"batch", (folder / "missing.json").string()}).exit_code == 1);
}
