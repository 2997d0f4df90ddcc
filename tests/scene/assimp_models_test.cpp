#include <sys/wait.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "support/paths.h"

namespace {

namespace fs = std::filesystem;

/// Runs `alabaster info` in a process of its own, so that a crash is a failure of this test and not its end.
struct Outcome {
  int exit_code = -1;
  std::vector<std::string> complaints;  // lines on standard error that are no remarks on defaults
};

Outcome run_info(const fs::path& model, const ScratchFolder& folder) {
  const fs::path errors = folder / "errors.txt";
  std::ostringstream command;
  command << program() << " info --json " << model << " > " << folder / "out.json"
          << " 2> " << errors;
  const int status = std::system(command.str().c_str());
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  std::ifstream in(errors);
  for (std::string line; std::getline(in, line);) outcome.complaints.push_back(line);
  return outcome;
}

}  // namespace

TEST_CASE("every glTF 2.0 file of assimp-testmodels loads or is refused in one line", "[slow]") {
  const fs::path models = "/usr/share/assimp/models/glTF2";
  if (!fs::is_directory(models)) {
    std::puts("SKIPPED: the Debian package assimp-testmodels is not installed");
    return;
  }
  const ScratchFolder folder;
  int loaded = 0, refused = 0;
  for (const auto& entry : fs::recursive_directory_iterator(models)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".gltf" && extension != ".glb") continue;
    const Outcome outcome = run_info(entry.path(), folder);
    INFO(entry.path().string() << ": exit code " << outcome.exit_code
                               << (outcome.complaints.empty() ? "" : ", " + outcome.complaints.back()));
    REQUIRE((outcome.exit_code == 0 || outcome.exit_code == 1));
    if (outcome.exit_code == 1) {
      // The one line names the file.
      CHECK(outcome.complaints.size() == 1);
      CHECK(outcome.complaints.at(0).find(entry.path().filename().string()) != std::string::npos);
    }
    (outcome.exit_code == 0 ? loaded : refused) += 1;
  }
  CHECK(loaded >= 20);
  CHECK(refused >= 10);
}
