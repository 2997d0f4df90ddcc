#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>

#include "support/paths.h"

namespace {

namespace fs = std::filesystem;

// The floors of docs/architecture.md. A file may include its own folder and folders on lower floors only.
const std::map<std::string, int> floor_of_folder{
    {"cli", 8},    {"study", 7},    {"integrators", 6}, {"bssrdf", 5}, {"scene", 5}, {"texture", 4},
    {"report", 4}, {"geometry", 3}, {"optics", 3},      {"image", 3},  {"core", 2}};

bool may_include(const std::string& from, const std::string& to) {
  return from == to || floor_of_folder.at(to) < floor_of_folder.at(from);
}

}  // namespace

TEST_CASE("no include runs up or across the floors") {
  const fs::path root = source_dir();
  const std::regex include(R"re(^\s*#\s*include\s*"([a-z_]+)/[^"]+")re");
  int checked = 0;
  for (const auto& [folder, floor] : floor_of_folder) {
    const fs::path place =
        folder == "geometry" || folder == "integrators" ? root / folder : root / "src" / folder;
    if (!fs::exists(place)) continue;  // a folder that has no files yet
    for (const auto& entry : fs::recursive_directory_iterator(place)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      std::ifstream file(entry.path());
      std::string line;
      for (int number = 1; std::getline(file, line); ++number) {
        std::smatch match;
        if (!std::regex_search(line, match, include)) continue;
        INFO(entry.path().string() << ":" << number << ": " << line);
        REQUIRE(floor_of_folder.count(match[1]) == 1);
        REQUIRE(may_include(folder, match[1]));
        ++checked;
      }
    }
  }
  REQUIRE(checked > 20);
}

TEST_CASE("the rule itself refuses upward and sideways includes") {
  CHECK_FALSE(may_include("core", "image"));
  CHECK_FALSE(may_include("bssrdf", "scene"));
  CHECK_FALSE(may_include("optics", "geometry"));
  CHECK(may_include("integrators", "bssrdf"));
}
