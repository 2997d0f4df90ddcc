// Every page the program writes, opened in a real headless browser: nothing fetched, nothing broken, nothing
// in the console, sliders that slide. Debian's chromium; skipped where it is not installed.
#include <catch2/catch.hpp>

#include "core/atomic_file.h"
#include "support/browser.h"
#include "support/paths.h"
#include "support/run_program.h"

namespace {

void check_page(const BrowserView& view) {
  CHECK(view.console.empty());
  CHECK(view.broken_images == 0);
  CHECK(view.stuck_sliders == 0);
  CHECK(view.unlabelled == 0);
  CHECK(view.requests == 0);
  CHECK(view.screenshot > 20000);
}

/// Writes the pages of `command` into a fresh folder, and looks at `page` in it.
BrowserView look(std::vector<std::string> command, const char* page) {
  const ScratchFolder folder;
  const std::filesystem::path out = folder / "out";
  command.insert(command.end(), {"-o", out.string()});
  const ProgramRun run = run_program(command);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const BrowserView view = view_in_browser(out / page);
  check_page(view);
  return view;
}

bool skipped() {
  if (browser_installed()) return false;
  WARN("SKIPPED: chromium is not installed, the page was not opened");
  return true;
}

const std::vector<std::string> small_mesh = {"--scenes",          "sphere_3", "--resolution", "24",
                                             "--reference-noise", "0.3",      "--cache"};

std::vector<std::string> on_small_mesh(std::vector<std::string> command, const ScratchFolder& cache) {
  command.insert(command.end(), small_mesh.begin(), small_mesh.end());
  command.push_back(cache.path().string());
  return command;
}

}  // namespace

TEST_CASE("a broken page is seen to be broken", "[slow]") {
  if (skipped()) return;
  const ScratchFolder folder;
  const std::filesystem::path page = folder / "page.html";
  alabaster::write_text_atomically(page, R"(<!DOCTYPE html><html><head><title>broken</title></head><body>
<img src="missing.png"><script>undefined_function()</script>
<div class="compare"><img class="left" src="data:image/png;base64,AAAA" alt="x">
<select><option>a</option><option>b</option></select><input type="range"></div></body></html>)");
  const BrowserView view = view_in_browser(page);
  CHECK(view.images == 2);
  CHECK(view.broken_images == 2);
  CHECK(view.sliders == 1);
  CHECK(view.stuck_sliders == 1);
  CHECK(view.unlabelled == 3);
  CHECK(view.requests >= 1);
  CHECK(view.console.find("undefined_function") != std::string::npos);
}

TEST_CASE("the page of the flat laboratory works in a browser", "[slow]") {
  if (skipped()) return;
  const BrowserView view =
      look({"validate", "--scenes", "constant", "--models", "homogeneous,composite"}, "report.html");
  CHECK(view.sliders >= 1);
  CHECK(view.images >= 5);  // the reference, two models, two differences
}

TEST_CASE("the page of errors on meshes works in a browser", "[slow]") {
  if (skipped()) return;
  const ScratchFolder cache;
  const BrowserView view =
      look(on_small_mesh({"validate", "--models", "homogeneous+half-space,composite+shape"}, cache),
           "report.html");
  CHECK(view.sliders == 1);
  CHECK(view.images >= 5);
}

TEST_CASE("the page of responses works in a browser", "[slow]") {
  if (skipped()) return;
  const BrowserView view =
      look({"validate", "--what", "response", "--scenes", "sphere_3", "--models", "composite+shape"},
           "response.html");
  CHECK(view.images >= 2);
}

TEST_CASE("the page of error over time works in a browser", "[slow]") {
  if (skipped()) return;
  const ScratchFolder cache;
  const BrowserView view =
      look(on_small_mesh({"chart", "--methods", "composite+half-space,walk"}, cache), "chart.html");
  CHECK(view.images >= 3);
}

TEST_CASE("the page of geodesic distances works in a browser", "[slow]") {
  if (skipped()) return;
  look({"chart", "--what", "geodesic"}, "chart.html");
}

TEST_CASE("the page of pyramids works in a browser", "[slow]") {
  if (skipped()) return;
  look({"chart", "--what", "pyramids"}, "chart.html");
}
