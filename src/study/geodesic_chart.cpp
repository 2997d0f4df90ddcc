#include "study/geodesic_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "geometry/geodesic.h"
#include "geometry/shapes.h"
#include "report/html_report.h"

namespace alabaster {

namespace {

/// True distances from a point to others; nothing where there is no way.
using Truth =
    std::function<std::vector<std::optional<double>>(const SurfacePoint&, std::span<const SurfacePoint>)>;

struct Surface {
  std::string name, description;
  TriangleMesh mesh;
  std::function<double(const Vec3&, const Vec3&)> exact;  // empty: measured, see best_known()
};

std::vector<Surface> surfaces() {
  return {
      {"plane", "a square of side 2", make_plane(2, 48),
       [](const Vec3& a, const Vec3& b) { return glm::distance(a, b); }},
      {"sphere", "a ball of radius 1", make_blob(1, 0, 96),
       [](const Vec3& a, const Vec3& b) {
         return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
       }},
      {"blob", "a ball with bumps of a quarter of its radius", make_blob(1, 0.25, 64), {}},
      {"fold", "a sheet of thickness 0.2 folded over a gap of 0.1", make_folded_sheet(2, 0.2, 0.1, 48), {}}};
}

constexpr std::pair<double, double> ranges[] = {{0.05, 0.15}, {0.5, 1.5}};

struct Pair {
  SurfacePoint from, to;
  double truth;
};

SurfacePoint random_point(const TriangleMesh& mesh, Rng& rng) {
  const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
  const double r = std::sqrt(rng.uniform());
  return mesh.surface_point(t, {r * rng.uniform(), 1 - r});
}

/// Pairs by range: targets near a source and anywhere, those kept whose true distance is in the range.
std::vector<std::vector<Pair>> find_pairs(const Surface& surface, const RayScene& rays, const Truth& truth,
                                          const GeodesicChartOptions& options) {
  Rng rng(options.seed);
  const auto wanted = static_cast<std::size_t>(options.pairs);
  constexpr int targets_per_source = 12, most_sources = 200;
  std::vector<std::vector<Pair>> pairs(std::size(ranges));
  for (int n = 0; n < most_sources; ++n) {
    const SurfacePoint from = random_point(surface.mesh, rng);
    std::vector<SurfacePoint> targets;
    for (int i = 0; i < targets_per_source; ++i) {
      const Vec3 aside = 0.24 * (Vec3(rng.uniform(), rng.uniform(), rng.uniform()) - 0.5);
      const auto near = rays.closest_point(0, from.position + aside);
      targets.push_back(surface.mesh.surface_point(near->triangle, near->barycentric));
      targets.push_back(random_point(surface.mesh, rng));
    }
    const auto distances = truth(from, targets);
    bool enough = true;
    for (std::size_t r = 0; r < std::size(ranges); ++r) {
      for (std::size_t i = 0; i < targets.size(); ++i)
        if (distances[i] && *distances[i] >= ranges[r].first && *distances[i] <= ranges[r].second &&
            pairs[r].size() < wanted)
          pairs[r].push_back({from, targets[i], *distances[i]});
      enough = enough && pairs[r].size() == wanted;
    }
    if (enough) break;
  }
  return pairs;
}

Truth closed_form(const std::function<double(const Vec3&, const Vec3&)>& exact) {
  return [exact](const SurfacePoint& from, std::span<const SurfacePoint> to) {
    std::vector<std::optional<double>> all;
    for (const SurfacePoint& p : to) all.emplace_back(exact(from.position, p.position));
    return all;
  };
}

/// The shorter of two ways over the surface: the straightest, which is the shortest wherever that has no
/// rival (against exact distances: docs/geodesics.md), and a Steiner graph's, which finds rivals.
Truth best_known(const TriangleMesh& mesh, const HalfEdgeMesh& half_edges) {
  const std::shared_ptr<const Geodesic> straightest = make_straightest_path(mesh, half_edges),
                                        graph = make_steiner_graph(mesh);
  return [straightest, graph](const SurfacePoint& from, std::span<const SurfacePoint> to) {
    auto all = graph->distances(from, to);
    for (std::size_t i = 0; i < to.size(); ++i)
      if (const auto other = straightest->distance(from, to[i]))
        all[i] = all[i] ? std::min(*all[i], *other) : *other;
    return all;
  };
}

GeodesicRow measure(const Geodesic& method, const std::vector<Pair>& pairs) {
  GeodesicRow row;
  row.method = method.name();
  row.pairs = static_cast<int>(pairs.size());
  std::vector<std::optional<double>> found(pairs.size());
  // Fast methods are asked often enough to be timed.
  const double start = cpu_seconds();
  int rounds = 0;
  for (double passed = 0; passed < 0.01 && rounds < 1000; ++rounds, passed = cpu_seconds() - start)
    for (std::size_t i = 0; i < pairs.size(); ++i) found[i] = method.distance(pairs[i].from, pairs[i].to);
  row.microseconds =
      1e6 * (cpu_seconds() - start) / rounds / std::max(1.0, static_cast<double>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!found[i]) {
      ++row.refused;
      continue;
    }
    const double error = *found[i] / pairs[i].truth - 1;
    row.mean_error += std::abs(error);
    row.bias += error;
    row.worst_error = std::max(row.worst_error, std::abs(error));
  }
  const int answered = std::max(1, row.pairs - row.refused);
  row.mean_error /= answered;
  row.bias /= answered;
  return row;
}

std::vector<GeodesicRow> measure_surface(const Surface& surface, const GeodesicChartOptions& options) {
  const TriangleMesh& mesh = surface.mesh;
  RayScene rays;
  rays.add(mesh);
  rays.commit();
  const HalfEdgeMesh half_edges(mesh);
  const Truth truth = surface.exact ? closed_form(surface.exact) : best_known(mesh, half_edges);
  const auto pairs = find_pairs(surface, rays, truth, options);
  const std::function<std::unique_ptr<Geodesic>()> makers[] = {
      [&] { return make_chord(mesh, rays, 0); },
      [&] { return make_normal_corrected_chord(mesh, rays, 0); },
      [&] { return make_projected_chord(mesh, rays, 0); },
      [&] { return make_straightest_path(mesh, half_edges); },
      [&] { return make_edge_graph(mesh, half_edges); },
      [&] { return make_heat_method(mesh, half_edges); }};
  std::vector<GeodesicRow> rows;
  for (const auto& make : makers) {
    const double start = cpu_seconds();
    const std::unique_ptr<Geodesic> method = make();
    const double setup = cpu_seconds() - start;
    for (std::size_t r = 0; r < std::size(ranges); ++r) {
      GeodesicRow row = measure(*method, pairs[r]);
      row.surface = surface.name;
      row.shortest = ranges[r].first, row.longest = ranges[r].second;
      row.setup_seconds = setup;
      rows.push_back(row);
    }
  }
  return rows;
}

// Errors below this are rounding and cannot be told apart on a logarithmic axis.
constexpr double least_error = 1e-7;

Chart chart_of(const Surface& surface, const std::vector<GeodesicRow>& rows) {
  Chart chart;
  chart.title = fmt::format("Distances over {}: {:.2f}-{:.2f} (left end), {:.1f}-{:.1f}", surface.description,
                            ranges[0].first, ranges[0].second, ranges[1].first, ranges[1].second);
  chart.x_label = "CPU microseconds per query";
  chart.y_label = fmt::format("mean relative error (not below {:g})", least_error);
  chart.log_x = chart.log_y = true;
  for (const GeodesicRow& row : rows) {
    if (row.surface != surface.name || row.refused == row.pairs) continue;
    if (chart.series.empty() || chart.series.back().name != row.method)
      chart.series.push_back({row.method, {}, {}});
    chart.series.back().x.push_back(row.microseconds);
    chart.series.back().y.push_back(std::max(row.mean_error, least_error));
  }
  return chart;
}

std::string per_cent(double value) {
  return fmt::format("{:.3g} %", 100 * value);
}

ReportTable table_of(const std::string& surface, const std::vector<GeodesicRow>& rows) {
  ReportTable table{
      "Errors over the pairs that got an answer",
      {"method", "distances", "mean error", "bias", "worst", "no way found", "us per query", "set-up, s"},
      {}};
  for (const GeodesicRow& row : rows)
    if (row.surface == surface)
      table.rows.push_back(
          {row.method, fmt::format("{} to {}", row.shortest, row.longest), per_cent(row.mean_error),
           per_cent(row.bias), per_cent(row.worst_error), fmt::format("{} of {}", row.refused, row.pairs),
           fmt::format("{:.3g}", row.microseconds), fmt::format("{:.2g}", row.setup_seconds)});
  return table;
}

nlohmann::ordered_json json_of(const std::vector<GeodesicRow>& rows) {
  auto all = nlohmann::ordered_json::array();
  for (const GeodesicRow& row : rows)
    all.push_back({{"surface", row.surface},
                   {"method", row.method},
                   {"shortest", row.shortest},
                   {"longest", row.longest},
                   {"mean_error", row.mean_error},
                   {"bias", row.bias},
                   {"worst_error", row.worst_error},
                   {"pairs", row.pairs},
                   {"refused", row.refused},
                   {"microseconds", row.microseconds},
                   {"setup_seconds", row.setup_seconds}});
  return all;
}

}  // namespace

std::vector<GeodesicRow> measure_geodesics(const GeodesicChartOptions& options) {
  std::vector<GeodesicRow> rows;
  for (const Surface& surface : surfaces()) {
    const auto more = measure_surface(surface, options);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  return rows;
}

void chart_geodesics(const GeodesicChartOptions& options) {
  const std::vector<GeodesicRow> rows = measure_geodesics(options);
  write_text_atomically(options.output / "chart.json", json_of(rows).dump(1) + "\n");
  HtmlReport report(
      "Alabaster: distances over surfaces",
      fmt::format("The error of each approximation of the distance over a surface against its cost. "
                  "Truth is the closed form on the plane and the sphere; on the others the shorter of the "
                  "straightest path and the best way through a Steiner graph. Seed {}.",
                  options.seed));
  for (const Surface& surface : surfaces()) {
    const Chart chart = chart_of(surface, rows);
    write_chart_files(options.output / ("geodesic_" + surface.name), chart);
    report.heading(surface.name + ": " + surface.description);
    report.chart(chart, "error over time per query of every method on the " + surface.name);
    report.table(table_of(surface.name, rows));
  }
  report.write(options.output / "chart.html");
}

}  // namespace alabaster
