#include "study/validation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/false_colour.h"
#include "image/png_file.h"
#include "study/html.h"
#include "study/line_chart.h"

namespace alabaster {

namespace {

using html::escape;

std::string percent(double v) {
  return fmt::format("{:+.1f} %", 100 * v);
}

/// What is shown as white: the value that one pixel in two hundred exceeds.
double white_level(const Image& image) {
  std::vector<float> values;
  for (int c = 0; c < 3; ++c)
    values.insert(values.end(), image.plane(c), image.plane(c) + image.width() * image.height());
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 995 / 1000);
  std::nth_element(values.begin(), place, values.end());
  return std::max(static_cast<double>(*place), 1e-30);
}

std::string picture(const Image& image, double white, const std::string& alternative) {
  Image colour(image.width(), image.height(), {"R", "G", "B"});
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) colour.set_rgb(0, x, y, image.rgb(0, x, y));
  return html::image(display_pixels(colour, -std::log2(white)), alternative);
}

std::string texture_picture(const PlanarScene& scene) {
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
  return html::image(display_pixels(image), "albedo texture of " + scene.name);
}

std::vector<float> signed_difference_of(const Image& a, const Image& b) {
  std::vector<float> result;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x)
      result.push_back(static_cast<float>((a.rgb(0, x, y) - b.rgb(0, x, y)).mean()));
  return result;
}

// ---- tables

std::vector<std::string> model_names(const ValidationResult& result) {
  std::vector<std::string> names;
  if (!result.scenes.empty())
    for (const MethodResult& m : result.scenes.front().methods) names.push_back(m.model);
  return names;
}

/// One row per scene, one column per model, the best of each row marked.
template <class Value, class Text>
std::string error_table(const ValidationResult& result, const std::string& caption, Value value, Text text) {
  html::Table table(caption);
  std::vector<std::string> head{"Scene", "floor (no texture)"};
  for (const std::string& name : model_names(result)) head.push_back(escape(name));
  table.head(head);
  for (const SceneResult& scene : result.scenes) {
    double best = 1e30;
    for (const MethodResult& m : scene.methods) best = std::min(best, value(m.errors));
    std::vector<std::string> cells{escape(scene.scene.name), text(scene.floor.errors)};
    for (const MethodResult& m : scene.methods)
      cells.push_back(value(m.errors) == best ? "<b>" + text(m.errors) + "</b>" : text(m.errors));
    table.row(cells);
  }
  return table.text();
}

std::string summary_tables(const ValidationResult& result) {
  std::string page;
  page += error_table(
      result, "Error of the image, RMSE / RMS, noise removed; &plusmn; 95 % interval",
      [](const ImageErrors& e) { return e.bias; },
      [](const ImageErrors& e) { return fmt::format("{:.3f} &plusmn; {:.3f}", e.bias, e.bias_interval); });
  page += error_table(
      result, "Mean absolute log ratio; &plusmn; 95 % interval",
      [](const ImageErrors& e) { return e.mean_abs_log_ratio; },
      [](const ImageErrors& e) {
        return fmt::format("{:.3f} &plusmn; {:.3f}{}", e.mean_abs_log_ratio, e.log_interval,
                           e.kept < 0.95 ? fmt::format(" (only {:.0f} % of pixels)", 100 * e.kept) : "");
      });
  page += error_table(
      result, "Bias of the mean", [](const ImageErrors& e) { return std::abs(e.mean_bias); },
      [](const ImageErrors& e) {
        return fmt::format("{} &plusmn; {:.1f} %", percent(e.mean_bias), 100 * e.mean_bias_interval);
      });
  return page;
}

std::string time_table(const ValidationResult& result) {
  html::Table table(
      "CPU seconds, samples per pixel and noise (RMSE / RMS of the image alone and its reference)");
  std::vector<std::string> head{"Scene", "reference"};
  for (const std::string& name : model_names(result)) head.push_back(escape(name));
  table.head(head);
  for (const SceneResult& scene : result.scenes) {
    const double pixels = scene.scene.view.width * scene.scene.view.height;
    std::vector<std::string> cells{escape(scene.scene.name),
                                   fmt::format("{:.1f} s, {:.1f} M paths", scene.reference.cpu_seconds,
                                               1e-6 * static_cast<double>(scene.reference.samples))};
    for (const MethodResult& m : scene.methods)
      cells.push_back(fmt::format("{:.1f} s, {:.0f} spp, {:.3f}", m.render.cpu_seconds,
                                  static_cast<double>(m.render.samples) / pixels, m.errors.noise));
    table.row(cells);
  }
  return table.text();
}

// ---- one scene

std::string scene_section(const SceneResult& scene) {
  const std::string& name = scene.scene.name;
  const Image& truth = scene.reference.image;
  const double white = white_level(truth);
  ColourScale scale;
  scale.high = 0.5 * white;
  scale.is_signed = true;
  std::string top = html::figure(texture_picture(scene.scene), "albedo");
  top += html::figure(picture(truth, white, "reference image of " + name), "reference", "reference");
  std::string bottom;
  for (const MethodResult& m : scene.methods) {
    const ImageErrors& e = m.errors;
    top += html::figure(picture(m.render.image, white, m.model + " on " + name), escape(m.model), m.model);
    const Pixels8 difference =
        false_colour(signed_difference_of(m.render.image, truth), truth.width(), truth.height(), scale);
    bottom += html::figure(
        html::image(difference, "signed difference of " + m.model + " from the reference on " + name),
        fmt::format("{}: {:.3f}, log {:.3f}, mean {}", escape(m.model), e.rmse_over_rms, e.mean_abs_log_ratio,
                    percent(e.mean_bias)));
  }
  std::string text = fmt::format("<section class=scene id=\"{0}\"><h3>{1} <small>{0}</small></h3>",
                                 escape(name), escape(scene.scene.title));
  text += "<div class=row>" + top + "</div>" + html::slider(name);
  text += fmt::format(
      "<p>Differences from the reference, blue darker, red brighter, full colour at half of white. Floor: "
      "the homogeneous model "
      "on a constant texture is off by {:.3f} (log {:.3f}, mean {}).</p><div class=row>{}</div></section>",
      scene.floor.errors.rmse_over_rms, scene.floor.errors.mean_abs_log_ratio,
      percent(scene.floor.errors.mean_bias), bottom);
  return text;
}

// ---- charts

std::string width_chart(const ValidationResult& result) {
  LineChart chart("Aggregate: error by the width of its ellipse", "width / distance",
                  "RMSE / RMS, noise removed");
  for (const SceneResult& scene : result.scenes) {
    LineChart::Series series{scene.scene.name, {}};
    for (const MethodResult& m : scene.sweep)
      series.points.emplace_back(parse_planar_method(m.model).options.ellipse_width, m.errors.bias);
    if (!series.points.empty()) chart.add(series);
  }
  return chart.empty() ? "" : chart.svg();
}

std::string density_chart(const ValidationResult& result) {
  LineChart chart("Colour bleeding: error by density", "density (relative)", "RMSE / RMS, noise removed");
  chart.logarithmic_x = true;
  const std::string prefix = "colour_bleeding_x";
  std::vector<LineChart::Series> all;
  const auto add = [&](const std::string& name, double x, double y) {
    auto place = std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.name == name; });
    if (place == all.end()) place = all.insert(all.end(), {name, {}});
    place->points.emplace_back(x, y);
  };
  for (const SceneResult& scene : result.scenes) {
    if (scene.scene.name.rfind(prefix, 0) != 0) continue;
    const double density = 1 / scene.scene.medium.mean_free_path.r;
    for (const MethodResult& m : scene.methods)
      if (m.model.find(':') == std::string::npos) add(m.model, density, m.errors.bias);
    add("floor", density, scene.floor.errors.bias);
  }
  for (const auto& series : all) chart.add(series);
  return chart.empty() ? "" : chart.svg();
}

// ---- kernels and footprints

std::string kernel_section(const ValidationResult& result) {
  if (result.maps.empty()) return "";
  std::string text =
      "<h2>Kernels</h2><p>S(x, exit) for one exit point over the view, 1/m&sup2;, logarithmic; the reference "
      "by reciprocity. "
      "Grey levels below the scale hold no light.</p>";
  for (const KernelMap& map : result.maps) {
    ColourScale scale;
    scale.logarithmic = true;
    const Image& truth = map.maps.front().second;
    float highest = 0;
    for (int i = 0; i < truth.width() * truth.height(); ++i) highest = std::max(highest, truth.plane(1)[i]);
    scale.high = static_cast<double>(highest);
    scale.low = 1e-6 * scale.high;
    text += fmt::format("<h3>{}, exit at ({:.2f}, {:.2f})</h3><div class=row>", escape(map.scene), map.exit.x,
                        map.exit.y);
    for (const auto& [name, image] : map.maps) {
      std::vector<float> values;
      for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
          values.push_back(static_cast<float>(image.rgb(0, x, y).mean()));
      text += html::figure(
          html::image(with_legend(false_colour(values, image.width(), image.height(), scale), scale),
                      "kernel of " + name + " on " + map.scene),
          escape(name));
    }
    text += "</div>";
  }
  return text;
}

std::string footprint_picture(const Footprint& f, bool paper) {
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
  return html::image(
      false_colour(values, Footprint::columns, Footprint::rows, scale),
      paper ? "density of eq. 1" : fmt::format("density of path vertices at distance {}", f.distance));
}

std::string footprint_section(const ValidationResult& result) {
  if (result.footprints.empty()) return "";
  std::string text =
      "<h2>The paper's footprint</h2><p>Vertices of light paths between entry (0, 0) and exit (1, 0), seen "
      "from above, unweighted, "
      "paths of at most 100 collisions; 3 x 2 distances across; beside it eq. 1. One logarithmic scale, "
      "0.003 to 3 per squared distance.</p>"
      "<div class=row>";
  for (std::size_t i = 0; i < result.footprints.size(); ++i)
    if (result.footprint_options[i].max_order == 100 && result.footprint_options[i].albedo == 1)
      for (const Footprint& f : result.footprints[i])
        text += html::figure(footprint_picture(f, false), fmt::format("distance {}", f.distance));
  text += html::figure(footprint_picture({}, true), "eq. 1") + "</div>";
  html::Table table(
      "Best fits of eq. 1's form (weights w, positions t = standard deviations, in distances; eq. 1 has 4/7, "
      "2/7, 1/7 = 0.571, "
      "0.286, 0.143) and moments of the vertices");
  table.head({"albedo", "orders up to", "distance", "vertices per path", "deviation along", "across", "w",
              "t", "gain in log likelihood"});
  for (std::size_t i = 0; i < result.footprints.size(); ++i)
    for (const Footprint& f : result.footprints[i])
      table.row({fmt::format("{}", result.footprint_options[i].albedo),
                 fmt::format("{}", result.footprint_options[i].max_order), fmt::format("{}", f.distance),
                 fmt::format("{:.1f}", f.vertices_per_path), fmt::format("{:.2f}", f.deviation_along),
                 fmt::format("{:.2f}", f.deviation_across),
                 fmt::format("{:.2f} {:.2f} {:.2f}", f.fit.weight[0], f.fit.weight[1], f.fit.weight[2]),
                 fmt::format("{:.2f} {:.2f} {:.2f}", f.fit.position[0], f.fit.position[1], f.fit.position[2]),
                 fmt::format("{:.3f}", f.log_likelihood_gain)});
  return text + table.text();
}

}  // namespace

std::string validation_page(const ValidationResult& result, const ValidationOptions& options) {
  std::string body = "<h1>SV-BSSRDF models on the plane</h1>";
  body += fmt::format(
      "<p>Every model against the volumetric reference of the heterogeneous half-space: g = 0.3, eta = 1.5, "
      "uniform light on a patch, "
      "specular reflection left out. Quality {}, seed {}, {:.0f} s ({:.0f} CPU s).</p>",
      options.quality == Quality::quick ? "quick" : "full", options.seed, result.seconds, result.cpu_seconds);
  if (result.cancelled) body += "<p><b>Stopped before the end: some scenes are missing.</b></p>";
  body += "<h2>Errors</h2>" + summary_tables(result);
  body += "<h2>Charts</h2><div class=row>" + density_chart(result) + width_chart(result) + "</div>";
  body += "<h2>Images</h2>";
  for (const SceneResult& scene : result.scenes) body += scene_section(scene);
  body += kernel_section(result) + footprint_section(result);
  body += "<h2>Time</h2>" + time_table(result);
  return html::page("Alabaster: validation on the plane", body);
}

}  // namespace alabaster
