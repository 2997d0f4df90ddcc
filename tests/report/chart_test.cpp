#include "report/chart.h"

#include <stdlib.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/atomic_file.h"
#include "core/error.h"
#include "image/image_decode.h"
#include "support/paths.h"

using namespace alabaster;

namespace {

Chart example() {
  Chart chart{"Error & \"time\"", "CPU time [s]", "RMSE / RMS", true, true, {}};
  chart.series.push_back({"composite", {1, 2, 4}, {0.4, 0.2, 0.1}, {0.05, 0.02, 0.2}});
  chart.series.push_back({"walk_{1}", {1, 2, 0, 4}, {0.9, NAN, 0.5, 0.3}, {}, false});
  return chart;
}

}  // namespace

TEST_CASE("a chart becomes SVG and PNG of the size asked for") {
  const ScratchFolder folder;
  const std::string svg = chart_svg(example());
  CHECK(svg.find("<svg") != std::string::npos);
  CHECK(svg.find("<title>Error &amp; &quot;time&quot;</title>") != std::string::npos);
  CHECK(svg.find("walk_{1}") != std::string::npos);  // names are not taken for markup
  CHECK(svg.find("RMSE / RMS") != std::string::npos);
  write_chart_svg(folder / "c.svg", example());
  CHECK(read_text(folder / "c.svg").size() > 1000);
  write_chart_png(folder / "c.png", example());
  const DecodedImage png = read_image(folder / "c.png");
  CHECK(png.width == 800);
  CHECK(png.height == 520);
}

TEST_CASE("what a logarithmic axis cannot show is left out") {
  const std::string script = gnuplot_script(example(), "svg", "x.svg");
  CHECK(script.find("set logscale x") != std::string::npos);
  CHECK(script.find("\n1 0.9 0.9 0.9\n4 0.3 0.3 0.3\n") != std::string::npos);
  CHECK(script.find("4 0.1 0.0001 0.3") != std::string::npos);  // the bar stops above 0
  Chart empty{"none", "x", "y", false, true, {{"s", {1, 2}, {0, -1}}}};
  CHECK_THROWS_AS(chart_svg(empty), InputError);
}

TEST_CASE("a missing gnuplot is said, with the package to install") {
  const ScratchFolder folder;
  const char* path = std::getenv("PATH");
  const std::string saved = path != nullptr ? path : "";
  setenv("PATH", folder.path().c_str(), 1);
  CHECK_THROWS_WITH(chart_svg(example()), Catch::Contains("gnuplot-nox"));
  setenv("PATH", saved.c_str(), 1);
}
