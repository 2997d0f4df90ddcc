#include "core/atomic_file.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <stdexcept>

#include "core/error.h"
#include "support/paths.h"

using namespace alabaster;
namespace fs = std::filesystem;

TEST_CASE("a failed write leaves the old file and nothing else") {
  const ScratchFolder scratch;
  const fs::path target = scratch / "out.txt";
  write_text_atomically(target, "old");
  CHECK_THROWS_AS(write_file_atomically(target,
                                        [](const fs::path& temporary) {
                                          std::ofstream(temporary) << "half";
                                          throw std::runtime_error("disk full");
                                        }),
                  std::runtime_error);
  CHECK(read_text(target) == "old");
  CHECK(std::distance(fs::directory_iterator(scratch.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("the temporary stands beside the target and keeps its ending") {
  const ScratchFolder scratch;
  write_file_atomically(scratch / "deep/er/a.exr", [&](const fs::path& temporary) {
    CHECK(temporary.extension() == ".exr");
    CHECK(temporary.parent_path() == scratch / "deep/er");
    std::ofstream(temporary) << "x";
  });
  CHECK(read_text(scratch / "deep/er/a.exr") == "x");
}

TEST_CASE("files that cannot be read or written are one line that names them") {
  const ScratchFolder scratch;
  CHECK_THROWS_WITH(read_text(scratch / "absent"),
                    Catch::Contains("absent") && Catch::Contains("cannot be read"));
  CHECK_THROWS_WITH(read_text(scratch.path()), Catch::Contains("is a folder"));
  CHECK_THROWS_WITH(write_text_atomically(scratch.path(), ""), Catch::Contains("is a folder"));
  write_text_atomically(scratch / "file", "");
  CHECK(read_text(scratch / "file").empty());
  CHECK_THROWS_AS(write_text_atomically(scratch / "file/below", ""), InputError);
}
