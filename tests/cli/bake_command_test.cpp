#include <catch2/catch.hpp>

#include "core/atomic_file.h"
#include "support/paths.h"
#include "support/run_program.h"

using namespace alabaster;

TEST_CASE("bake writes the same table again for the same seed") {
  const ScratchFolder folder;
  const auto bake = [&](const char* name, const char* seed) {
    const std::filesystem::path file = folder / name;
    const ProgramRun run = run_program({"bake", "--photons", "20000", "--seed", seed, "-o", file.string()});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return read_text(file);
  };
  const std::string once = bake("a.table", "7");
  CHECK(bake("b.table", "7") == once);
  CHECK(bake("c.table", "8") != once);
}

TEST_CASE("bake --report of too few photons asks for more in one line") {
  const ScratchFolder folder;
  const ProgramRun run = run_program({"bake", "--photons", "20000", "-o", (folder / "a.table").string(),
                                      "--report", (folder / "report").string()});
  CHECK(run.exit_code == 1);
  CHECK(run.error_lines() == 1);
  CHECK(run.err.find("--photons 500000") != std::string::npos);
}
