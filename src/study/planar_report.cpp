#include "study/planar_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bssrdf/aggregation_kernel.h"
#include "image/false_colour.h"
#include "study/kernel_picture.h"
#include "study/planar_scene_file.h"
#include "study/report_pictures.h"

namespace alabaster {

namespace {

constexpr int picture_width = 200;  // px on the page: a row of models fits a screen

ReportImage texture_picture(const PlanarScene& scene) {
  // The part of the plane the view shows, texel by texel.
  const PlanarView& view = scene.view;
  const TexelArray& texels = *scene.albedo;
  Image image(view.width, view.height, {"R", "G", "B"});
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const Vec2 uv = scene.uv(view.point(Vec2(x, y) + 0.5));
      const Vec2 st = (uv - glm::floor(uv)) * Vec2(texels.width, texels.height);
      const Vec4f& t = texels.at(std::min(static_cast<int>(st.x), texels.width - 1),
                                 std::min(static_cast<int>(st.y), texels.height - 1));
      image.set_rgb(0, x, y, Rgb(t.x, t.y, t.z));
    }
  return {display_pixels(image), "albedo", "albedo texture of " + scene.name};
}

// ---- tables

std::vector<std::string> table_head(const ValidationResult& result, const std::string& second) {
  std::vector<std::string> head{"Scene", second};
  for (const MethodResult& m : result.scenes.front().methods) head.push_back(m.model);
  return head;
}

/// One row per scene, one column per model, the best of each row emphasised.
template <class Value, class Text>
void error_table(HtmlReport& report, const ValidationResult& result, const std::string& caption, Value value,
                 Text text) {
  ReportTable table{caption, table_head(result, "floor (no texture)"), {}};
  for (const SceneResult& scene : result.scenes) {
    std::vector<double> values;
    std::vector<std::string> cells{scene.scene.name, text(scene.floor.errors)};
    for (const MethodResult& m : scene.methods) {
      values.push_back(value(m.errors));
      cells.push_back(text(m.errors));
    }
    table.best.push_back(best_column(values, 2));
    table.rows.push_back(std::move(cells));
  }
  report.table(table);
}

void error_tables(HtmlReport& report, const ValidationResult& result) {
  error_table(
      report, result, "Error of the image, RMSE / RMS, noise removed; ± 95 % interval",
      [](const Metrics& e) { return *e.bias; },
      [](const Metrics& e) { return with_interval(*e.bias, *e.bias_interval); });
  error_table(
      report, result, "Mean absolute log ratio; ± 95 % interval",
      [](const Metrics& e) { return e.mean_abs_log_ratio; }, log_ratio_text);
  error_table(
      report, result, "Bias of the mean", [](const Metrics& e) { return std::abs(e.mean_bias); },
      [](const Metrics& e) { return percent_with_interval(e.mean_bias, *e.mean_bias_interval); });
}

void time_table(HtmlReport& report, const ValidationResult& result) {
  ReportTable table{"CPU seconds, samples per pixel and noise (RMSE / RMS, image and reference together)",
                    table_head(result, "reference"),
                    {}};
  for (const SceneResult& scene : result.scenes) {
    const double pixels = scene.scene.view.width * scene.scene.view.height;
    std::vector<std::string> cells{scene.scene.name,
                                   fmt::format("{:.1f} s, {:.1f} M paths", scene.reference.cpu_seconds,
                                               1e-6 * static_cast<double>(scene.reference.samples))};
    for (const MethodResult& m : scene.methods)
      cells.push_back(fmt::format("{:.1f} s, {:.0f} spp, {:.3f}", m.render.cpu_seconds,
                                  static_cast<double>(m.render.samples) / pixels, *m.errors.noise));
    table.rows.push_back(std::move(cells));
  }
  report.table(table);
}

// ---- one scene

void scene_section(HtmlReport& report, const SceneResult& scene) {
  const std::string& name = scene.scene.name;
  const Image& truth = scene.reference.image;
  const double white = white_level(truth);
  report.heading(fmt::format("{} ({})", scene.scene.title.empty() ? name : scene.scene.title, name), 3);
  report.images({texture_picture(scene.scene)}, "", picture_width);
  std::vector<ReportImage> images{picture(truth, white, "reference", "reference image of " + name)},
      differences;
  std::size_t composite = 1;
  for (const MethodResult& m : scene.methods) {
    if (m.model == "composite") composite = images.size();
    images.push_back(picture(m.render.image, white, m.model, m.model + " on " + name));
    differences.push_back(
        difference_picture(m.render.image, truth, white,
                           fmt::format("{}: {:.3f}, log {:.3f}, mean {}", m.model, m.errors.rmse_over_rms,
                                       m.errors.mean_abs_log_ratio, percent(m.errors.mean_bias)),
                           "signed difference of " + m.model + " from the reference on " + name));
  }
  const std::vector<int> handles = report.images(images, "", picture_width);
  if (images.size() > 1) report.slider(handles, name + ", any two", 0, composite);
  report.images(
      differences,
      fmt::format(
          "Differences from the reference, blue darker, red brighter, full colour at half of white. Floor: "
          "the homogeneous model on a constant texture is off by {:.3f} (log {:.3f}, mean {}).",
          scene.floor.errors.rmse_over_rms, scene.floor.errors.mean_abs_log_ratio,
          percent(scene.floor.errors.mean_bias)),
      picture_width);
}

// ---- charts

void add_point(Chart& chart, const std::string& name, double x, double y) {
  auto place =
      std::find_if(chart.series.begin(), chart.series.end(), [&](const auto& s) { return s.name == name; });
  if (place == chart.series.end()) place = chart.series.insert(chart.series.end(), {name, {}, {}});
  place->x.push_back(x);
  place->y.push_back(y);
}

void width_chart(HtmlReport& report, const ValidationResult& result) {
  Chart chart{"Aggregate: error by the width of its ellipse",
              "width / distance",
              "RMSE / RMS, noise removed",
              false,
              false,
              {}};
  for (const SceneResult& scene : result.scenes)
    for (const MethodResult& m : scene.sweep)
      add_point(chart, scene.scene.name, parse_planar_method(m.model).options.ellipse_width, *m.errors.bias);
  if (!chart.series.empty()) report.chart(chart, "error of the aggregate model over its ellipse's width");
}

void density_chart(HtmlReport& report, const ValidationResult& result) {
  Chart chart{"Colour bleeding: error by density",
              "density (relative)",
              "RMSE / RMS, noise removed",
              true,
              false,
              {}};
  const std::string prefix = "colour_bleeding_x";
  for (const SceneResult& scene : result.scenes) {
    if (scene.scene.name.rfind(prefix, 0) != 0) continue;
    const double density = 1 / scene.scene.medium.mean_free_path.r;
    for (const MethodResult& m : scene.methods)
      if (m.model.find(':') == std::string::npos) add_point(chart, m.model, density, *m.errors.bias);
    add_point(chart, "floor", density, *scene.floor.errors.bias);
  }
  if (!chart.series.empty()) report.chart(chart, "error of each model over the density of the medium");
}

// ---- kernels and footprints

// [EK17] figures 2 and 3: what lies between the exit and an entry on the light's side of it.
void kernel_over_texture_row(HtmlReport& report, const ValidationResult& result, const KernelMap& map) {
  for (const SceneResult& measured : result.scenes) {
    const PlanarScene& scene = measured.scene;
    if (scene.name != map.scene) continue;
    const Vec2 to_light = scene.light.centre - map.exit;
    const Vec2 direction = glm::length(to_light) > 0 ? glm::normalize(to_light) : Vec2(1, 0);
    const Vec2 entry = map.exit + 1.5 * scene.medium.mean_free_path.r * direction;
    constexpr int size = 240;
    report.images(
        {{kernel_over_texture(scene, entry, map.exit, ek17_kernel, size), "kernel of composite",
          "the three Gaussians of eq. 1 between entry and exit, over the texture of " + map.scene},
         {kernel_over_texture(scene, entry, map.exit, symmetric_ek17_kernel, size),
          "kernel of composite:symmetric",
          "the six Gaussians of the symmetric kernel, over the texture of " + map.scene}},
        "Where the albedo between two points 1.5 mean free paths apart is looked for: density in orange, a "
        "line at one standard deviation of each Gaussian, the entry white, the exit black.",
        picture_width);
    return;
  }
}

void kernel_section(HtmlReport& report, const ValidationResult& result) {
  if (result.maps.empty()) return;
  report.heading("Kernels");
  report.paragraph(
      "S(x, exit) for one exit point over the view, 1/m², logarithmic; the reference by reciprocity. Grey "
      "levels below the scale hold no light.");
  for (const KernelMap& map : result.maps) {
    ColourScale scale;
    scale.logarithmic = true;
    const Image& truth = map.maps.front().second;
    float highest = 0;
    for (int i = 0; i < truth.width() * truth.height(); ++i) highest = std::max(highest, truth.plane(1)[i]);
    scale.high = static_cast<double>(highest);
    scale.low = 1e-6 * scale.high;
    report.heading(fmt::format("{}, exit at ({:.2f}, {:.2f})", map.scene, map.exit.x, map.exit.y), 3);
    std::vector<ReportImage> images;
    for (const auto& [name, image] : map.maps) {
      std::vector<float> values;
      for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
          values.push_back(static_cast<float>(image.rgb(0, x, y).mean()));
      images.push_back({with_legend(false_colour(values, image.width(), image.height(), scale), scale), name,
                        "kernel of " + name + " on " + map.scene});
    }
    report.images(images, "", picture_width);
    kernel_over_texture_row(report, result, map);
  }
}

ReportImage footprint_picture(const Footprint& f, bool paper) {
  ColourScale scale;
  scale.logarithmic = true;
  scale.low = 0.003;
  scale.high = 3;
  std::vector<float> values;
  const FootprintFit eq1;
  for (int row = 0; row < Footprint::rows; ++row)
    for (int column = 0; column < Footprint::columns; ++column)
      values.push_back(
          static_cast<float>(paper ? eq1.density(Footprint::along(column), Footprint::across(row))
                                   : f.density[static_cast<std::size_t>(row * Footprint::columns + column)]));
  return {false_colour(values, Footprint::columns, Footprint::rows, scale),
          paper ? "eq. 1" : fmt::format("distance {}", f.distance),
          paper ? "density of eq. 1" : fmt::format("density of path vertices at distance {}", f.distance)};
}

void footprint_section(HtmlReport& report, const ValidationResult& result) {
  if (result.footprints.empty()) return;
  report.heading("The paper's footprint");
  std::vector<ReportImage> images;
  for (std::size_t i = 0; i < result.footprints.size(); ++i)
    if (result.footprint_options[i].max_order == 100 && result.footprint_options[i].albedo == 1)
      for (const Footprint& f : result.footprints[i]) images.push_back(footprint_picture(f, false));
  images.push_back(footprint_picture({}, true));
  report.images(images,
                "Vertices of light paths between entry (0, 0) and exit (1, 0), seen from above, unweighted, "
                "paths of at most 100 collisions; 3 x 2 distances across; beside it eq. 1. One logarithmic "
                "scale, 0.003 to 3 per squared distance.",
                picture_width);
  ReportTable table{
      "Best fits of eq. 1's form (weights w, positions t = standard deviations, in distances; eq. 1 has 4/7, "
      "2/7, 1/7 = 0.571, 0.286, 0.143) and moments of the vertices",
      {"albedo", "orders up to", "distance", "vertices per path", "deviation along", "across", "w", "t",
       "gain in log likelihood"},
      {}};
  for (std::size_t i = 0; i < result.footprints.size(); ++i)
    for (const Footprint& f : result.footprints[i])
      table.rows.push_back(
          {fmt::format("{}", result.footprint_options[i].albedo),
           fmt::format("{}", result.footprint_options[i].max_order), fmt::format("{}", f.distance),
           fmt::format("{:.1f}", f.vertices_per_path), fmt::format("{:.2f}", f.deviation_along),
           fmt::format("{:.2f}", f.deviation_across),
           fmt::format("{:.2f} {:.2f} {:.2f}", f.fit.weight[0], f.fit.weight[1], f.fit.weight[2]),
           fmt::format("{:.2f} {:.2f} {:.2f}", f.fit.position[0], f.fit.position[1], f.fit.position[2]),
           fmt::format("{:.3f}", f.log_likelihood_gain)});
  report.table(table);
}

// ---- energy and speed

void energy_section(HtmlReport& report, const ValidationResult& result) {
  if (result.excess.empty()) return;
  report.heading("Energy of eq. 2");
  report.paragraph(
      "Eq. 2 divides by the albedo between entry and exit twice, the basis brings back one factor: where "
      "dark "
      "texture lies between bright ends it returns more light than a medium as bright as its ends everywhere "
      "would (above 1), without bound as alpha_t goes to 0. Light that scattered once met one albedo, not "
      "two; "
      "treated apart (composite:order1) the rest stays bounded.");
  report.chart(energy_chart(profile_for(result.scenes.front().scene)),
               "energy of eq. 2 over the albedo between entry and exit");
  ReportTable table{
      "Pairs of points whose S_V exceeds the homogeneous basis at the texture's largest albedo, which no "
      "medium "
      "of that texture can",
      {"scene, model", "share of pairs", "mean excess", "worst"},
      {}};
  for (const auto& [name, e] : result.excess)
    table.rows.push_back({name, fmt::format("{:.2f} %", 100 * e.share),
                          e.share > 0 ? fmt::format("{:.2f} x", e.mean) : "none",
                          e.share > 0 ? fmt::format("{:.2f} x", e.worst) : "none"});
  report.table(table);
}

void speed_section(HtmlReport& report, const ValidationResult& result) {
  if (!result.speed) return;
  const PlanarSpeed& speed = *result.speed;
  ReportTable evaluations{
      fmt::format("Evaluations of S_V per second and core, the entry's albedo lookup included ({})",
                  speed.scene),
      {"model", "million per second", "cost over homogeneous"},
      {}};
  for (const auto& [model, rate] : speed.evaluations)
    evaluations.rows.push_back({model, fmt::format("{:.2f}", 1e-6 * rate),
                                fmt::format("{:.2f} x", speed.evaluations.front().second / rate)});
  if (!evaluations.rows.empty()) report.table(evaluations);
  ReportTable times{
      fmt::format("CPU seconds to 2 % noise ({}): (a) uniform over the light, (b) by the profile, (c) "
                  "both, the default, and the reference",
                  speed.scene),
      {"method", "CPU seconds", "faster than the reference"},
      {}};
  for (const auto& [method, seconds] : speed.seconds_to_2)
    times.rows.push_back({method, fmt::format("{:.3g}", seconds),
                          fmt::format("{:.2f} x", speed.reference_seconds_to_2 / seconds)});
  times.rows.push_back({"volumetric reference, every photon by itself",
                        fmt::format("{:.3g}", speed.reference_seconds_to_2), "1"});
  if (speed.lattice_seconds_to_2 > 0)
    times.rows.push_back(
        {"volumetric reference, a lattice of photons per walk (pixels err alike)",
         fmt::format("{:.3g}", speed.lattice_seconds_to_2),
         fmt::format("{:.2f} x", speed.reference_seconds_to_2 / speed.lattice_seconds_to_2)});
  report.table(times);
}

}  // namespace

void add_planar_sections(HtmlReport& report, const ValidationResult& result) {
  if (result.scenes.empty()) return;
  report.heading("Flat scenes: errors");
  report.paragraph(
      "Every model against the volumetric reference of the heterogeneous half-space: g = 0.3, eta = 1.5, "
      "uniform light on a patch, specular reflection left out.");
  error_tables(report, result);
  density_chart(report, result);
  width_chart(report, result);
  report.heading("Flat scenes: images");
  for (const SceneResult& scene : result.scenes) scene_section(report, scene);
  kernel_section(report, result);
  footprint_section(report, result);
  energy_section(report, result);
  report.heading("Flat scenes: time");
  time_table(report, result);
  speed_section(report, result);
}

}  // namespace alabaster
