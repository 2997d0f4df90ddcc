#include "study/speed_accuracy.h"

#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "study/speed_accuracy_output.h"
#include "support/paths.h"

using namespace alabaster;

TEST_CASE("the Pareto front holds what nothing beats in both time and error") {
  std::vector<ChartRow> rows(6);
  const double points[6][2] = {{1, 1}, {2, 0.5}, {2, 0.6}, {3, 0.5}, {4, 0.1}, {0.5, 2}};
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i].cpu_seconds = points[i][0], rows[i].rmse_over_rms = points[i][1];
  mark_front(rows);
  std::vector<bool> on_front;
  for (const ChartRow& row : rows) on_front.push_back(row.on_front);
  CHECK(on_front == std::vector<bool>{true, true, false, false, true, true});
}

TEST_CASE("the time to a noise scales with the variance, the reference's left out") {
  ChartRow row;
  row.cpu_seconds = 3;
  row.noise = 0.05;  // 0.04 of its own, 0.03 of the reference
  CHECK(seconds_to_noise(row, 0.03, 0.02) == Approx(12));
}

TEST_CASE("the chart has a row for every method and number of samples, and its front") {
  const ScratchFolder folder;
  ChartOptions options;
  options.scenes = {"sphere_30", "constant"};
  options.methods = {"homogeneous+half-space", "composite+half-space", "walk", "volume"};
  options.output = folder / "chart";
  options.cache = folder / "cache";
  ChartBudget budget;
  budget.flat.resolution = 10;
  budget.flat.reference_noise = 0.05;
  budget.mesh = {8, 0.05, 64, 16};
  budget.spp = {1, 16};
  options.budget = budget;
  const ChartResult result = chart_speed_and_accuracy(options);
  REQUIRE(result.scenes.size() == 2);

  const auto rows = nlohmann::json::parse(read_text(options.output / "chart.json"));
  std::map<std::string, int> count, front;
  for (const auto& row : rows) {
    ++count[row.at("scene")];
    if (row.at("on_front").get<bool>()) ++front[row.at("scene")];
    CHECK(row.at("cpu_seconds").get<double>() > 0);
    CHECK(row.at("seconds").get<double>() > 0);
    CHECK(row.at("noise").get<double>() > 0);
    CHECK(row.at("error").get<double>() <= row.at("rmse_over_rms").get<double>());
    for (const auto& other : rows)  // nothing on the front is beaten
      if (row.at("on_front") && other.at("scene") == row.at("scene"))
        CHECK_FALSE((other.at("cpu_seconds") < row.at("cpu_seconds") &&
                     other.at("rmse_over_rms") < row.at("rmse_over_rms")));
  }
  CHECK(count["sphere_30"] == 8);
  CHECK(count["constant"] == 6);  // no walk on the plane
  CHECK(front["sphere_30"] >= 1);
  CHECK(front["constant"] >= 1);
  for (const char* file : {"sphere_30.svg", "sphere_30.png", "constant.svg", "constant.png", "chart.html"})
    CHECK(std::filesystem::exists(options.output / file));
  CHECK(read_text(options.output / "sphere_30.svg").find("Pareto front") != std::string::npos);
  CHECK(read_text(options.output / "chart.html").find("walk") != std::string::npos);
}
