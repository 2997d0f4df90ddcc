#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "image/exr_file.h"
#include "image/png_file.h"
#include "support/paths.h"
#include "support/run_program.h"

using namespace alabaster;

namespace {

Image picture(double value, bool variance) {
  std::vector<std::string> names{"R", "G", "B"};
  if (variance) names.insert(names.end(), {"variance.R", "variance.G", "variance.B"});
  Image image(8, 6, names);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x) image.set_rgb(0, x, y, Rgb(value * (1 + x)));
  return image;
}

}  // namespace

TEST_CASE("compare prints the agreed keys as JSON on standard output alone") {
  const ScratchFolder folder;
  const std::string a = (folder / "a.exr").string(), b = (folder / "b.exr").string(),
                    diff = (folder / "d/diff.png").string();
  write_exr(a, picture(1.5, true));
  write_exr(b, picture(1, true));
  const ProgramRun run = run_program({"compare", a, b, "--json", "--diff", diff});
  REQUIRE(run.exit_code == 0);
  CHECK(run.err.empty());
  const auto json = nlohmann::json::parse(run.out);
  CHECK(json.at("rmse_over_rms").get<double>() == Approx(0.5));
  CHECK(json.at("bias").get<double>() == Approx(0.5));
  CHECK(json.at("noise").get<double>() == 0);
  CHECK(json.at("mean_bias").get<double>() == Approx(0.5));
  CHECK(json.at("mean_abs_log_ratio").get<double>() == Approx(std::log(1.5)));
  CHECK(json.at("kept").get<double>() == 1);
  CHECK(json.at("mean_a").get<double>() == Approx(6.75));
  CHECK(json.at("mean_b").get<double>() == Approx(4.5));
  CHECK(json.at("pixels").get<int>() == 48);
  CHECK(json.at("finite").get<bool>());
  CHECK(json.contains("rel_mse"));
  CHECK(std::filesystem::file_size(diff) > 100);

  const ProgramRun fitted = run_program({"compare", a, b, "--json", "--scale", "fit"});
  CHECK(nlohmann::json::parse(fitted.out).at("rmse_over_rms").get<double>() == Approx(0).margin(1e-6));
}

TEST_CASE("compare looks at what both pictures cover with --mask alpha") {
  const ScratchFolder folder;
  const std::string a = (folder / "a.exr").string(), b = (folder / "b.exr").string(),
                    opaque = (folder / "opaque.exr").string();
  Image first(4, 2, {"R", "G", "B", "A"}), second = first;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) {
      first.set_rgb(0, x, y, Rgb(x == 0 ? 100 : 3));
      second.set_rgb(0, x, y, Rgb(x == 3 ? 100 : 2));
      first.at(3, x, y) = x == 0 ? 0.4f : 1;   // the first column of A is hardly covered,
      second.at(3, x, y) = x == 3 ? 0.0f : 1;  // the last of B not at all
    }
  write_exr(a, first);
  write_exr(b, second);
  write_exr(opaque, picture(1, false));
  const ProgramRun run = run_program({"compare", a, b, "--json", "--mask", "alpha"});
  REQUIRE(run.exit_code == 0);
  const auto json = nlohmann::json::parse(run.out);
  CHECK(json.at("pixels").get<int>() == 4);
  CHECK(json.at("mean_a").get<double>() == Approx(3));
  CHECK(json.at("rmse_over_mean").get<double>() == Approx(0.5));
  const ProgramRun refused = run_program({"compare", a, opaque, "--mask", "alpha"});
  CHECK(refused.exit_code == 1);
  CHECK(refused.err.find("no alpha channel") != std::string::npos);
}

TEST_CASE("compare says what it lacks and refuses what it cannot") {
  const ScratchFolder folder;
  const std::string a = (folder / "a.exr").string(), b = (folder / "b.exr").string(),
                    small = (folder / "small.exr").string();
  write_exr(a, picture(1, true));
  write_exr(b, picture(1, false));
  write_exr(small, Image(2, 2, {"R", "G", "B"}));
  const ProgramRun run = run_program({"compare", a, b, "--json"});
  CHECK(run.exit_code == 0);
  CHECK(run.err.find("b.exr: has no variance channels") != std::string::npos);
  CHECK(nlohmann::json::parse(run.out).at("bias").is_null());
  for (const std::vector<std::string>& bad : {std::vector<std::string>{"compare", a, small},
                                              {"compare", a, (folder / "missing.exr").string()},
                                              {"compare", a, b, "--mask", small}}) {
    const ProgramRun refused = run_program(bad);
    CHECK(refused.exit_code == 1);
    CHECK(refused.out.empty());
    CHECK(refused.error_lines() == 1);
    CHECK(refused.err.find(".exr") != std::string::npos);
  }
  CHECK(run_program({"compare", a}).exit_code == 2);
}

TEST_CASE("compare takes masks and 8-bit pictures") {
  const ScratchFolder folder;
  const std::string a = (folder / "a.exr").string(), b = (folder / "b.exr").string(),
                    mask = (folder / "m.png").string();
  Image changed = picture(1, false);
  changed.set_rgb(0, 0, 0, Rgb(100));
  write_exr(a, changed);
  write_exr(b, picture(1, false));
  Pixels8 pixels(8, 6, 1);
  std::fill(pixels.bytes.begin(), pixels.bytes.end(), uint8_t{255});
  pixels.bytes[0] = 0;
  write_png(mask, pixels);
  const auto json = nlohmann::json::parse(run_program({"compare", a, b, "--json", "--mask", mask}).out);
  CHECK(json.at("pixels").get<int>() == 47);
  CHECK(json.at("rmse_over_rms").get<double>() == 0);
  CHECK(run_program({"compare", mask, mask}).exit_code == 0);
}
