#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/tiny_scene.h"
#include "support/paths.h"
#include "support/run_program.h"

namespace fs = std::filesystem;

TEST_CASE("describing a model bakes nothing, and an albedo that would need it is unknown") {
  const ScratchFolder folder;
  write_ball(folder.path());
  const auto described = [&](double eta) {
    const fs::path scene = write_text(folder / "scene.json",
                                      R"({"version": 1, "model": "ball.glb", "environment": {"radiance": 1},
          "materials": {"*": {"subsurface": true, "mean_free_path": 0.01, "eta": )" +
                                          std::to_string(eta) + "}}}");
    ProgramOptions options;
    options.environment = {{"XDG_CACHE_HOME", (folder / "cache").string()}};
    const ProgramRun run = run_program({"info", scene.string(), "--json"}, options);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    CHECK(run.err.find("baking") == std::string::npos);
    CHECK(run_program({"info", scene.string()}, options).out.find("mean albedo") != std::string::npos);
    return nlohmann::json::parse(run.out)["materials"][0]["medium"];
  };
  CHECK(described(1.5)["mean_albedo"][0].get<double>() > 0.9);
  const nlohmann::json unusual = described(1.37);
  CHECK(unusual["eta"] == 1.37);
  CHECK(unusual["mean_albedo"].is_null());
  CHECK_FALSE(fs::exists(folder / "cache"));
}
