#include <catch2/catch.hpp>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "image/exr_file.h"
#include "support/paths.h"

using namespace alabaster;

namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("alabaster validate writes rows, images and a page", "[slow]") {
  ScratchFolder folder;
  const std::string out = (folder / "report").string();
  const std::string command = program().string() +
                              " validate --scenes constant --models homogeneous,composite -o " + out +
                              " 2>/dev/null";
  REQUIRE(std::system(command.c_str()) == 0);

  const auto rows = nlohmann::json::parse(read_text(out + "/results.json"));
  REQUIRE(rows.size() == 2);
  for (const auto& row : rows) {
    CHECK(row.at("scene") == "constant");
    // One albedo: every model is the homogeneous one, and its error is the floor.
    CHECK(row.at("rmse_over_rms").get<double>() ==
          Approx(row.at("floor_rmse_over_rms").get<double>()).margin(0.02));
    for (const char* key : {"model", "bias", "noise", "mean_bias", "mean_abs_log_ratio", "kept", "seconds",
                            "cpu_seconds", "samples"})
      CHECK(row.contains(key));
  }
  CHECK(read_exr(out + "/constant/reference.exr").image.find("variance.G") >= 0);
  CHECK(read_exr(out + "/constant/composite.exr").image.width() == 100);

  const std::string page = read_text(out + "/report.html");
  CHECK(count(page, "http") == 0);  // nothing is fetched
  CHECK(count(page, "<img") == count(page, " alt=\""));
}
