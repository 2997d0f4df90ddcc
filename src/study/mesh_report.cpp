#include "study/mesh_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/report_pictures.h"

namespace alabaster {

namespace {

constexpr int picture_width = 200;  // px on the page

std::vector<std::string> table_head(const ValidationResult& result, const std::vector<std::string>& first) {
  std::vector<std::string> head = first;
  for (const MeshSceneResult& scene : result.meshes) {
    if (scene.methods.empty()) continue;
    for (const MeshMethodResult& m : scene.methods) head.push_back(m.model);
    break;
  }
  return head;
}

/// One row per scene, one column per method, the least value of each row emphasised.
template <class Value, class Text>
void method_table(HtmlReport& report, const ValidationResult& result, const std::string& caption, Value value,
                  Text text) {
  ReportTable table{caption, table_head(result, {"Scene"}), {}};
  for (const MeshSceneResult& scene : result.meshes) {
    if (scene.methods.empty()) continue;
    std::vector<double> values;
    std::vector<std::string> cells{scene.name};
    for (const MeshMethodResult& m : scene.methods) {
      values.push_back(value(m));
      cells.push_back(text(m));
    }
    table.best.push_back(best_column(values, 1));
    table.rows.push_back(std::move(cells));
  }
  report.table(table);
}

std::string bias_text(const Metrics& e) {
  return with_interval(*e.bias, e.bias_interval.value_or(0));
}
std::string mean_text(const Metrics& e) {
  return percent_with_interval(e.mean_bias, e.mean_bias_interval.value_or(0));
}

void error_tables(HtmlReport& report, const ValidationResult& result) {
  using M = MeshMethodResult;
  method_table(
      report, result, "Error of the image, RMSE / RMS, noise removed; ± 95 % interval",
      [](const M& m) { return *m.errors.bias; }, [](const M& m) { return bias_text(m.errors); });
  method_table(
      report, result, "Bias of the mean", [](const M& m) { return std::abs(m.errors.mean_bias); },
      [](const M& m) { return mean_text(m.errors); });
  method_table(
      report, result, "Mean absolute log ratio", [](const M& m) { return m.errors.mean_abs_log_ratio; },
      [](const M& m) { return log_ratio_text(m.errors); });
}

void cause_tables(HtmlReport& report, const ValidationResult& result) {
  using M = MeshMethodResult;
  report.heading("Meshes: errors by cause");
  report.list(
      {"Shape: the same scene with one albedo per object (the mean of its texture), method against "
       "reference. "
       "All models on one basis are the same there; walks have no such error.",
       "Aggregation: what the texture adds. The method's image is multiplied, pixel by pixel, by reference / "
       "method of the scene without texture; the error that is left is the texture's.",
       "Sampling: the noise of the method's image at this number of samples."});
  method_table(
      report, result, "Shape: RMSE / RMS, noise removed", [](const M& m) { return std::abs(*m.shape.bias); },
      [](const M& m) { return bias_text(m.shape) + ", mean " + percent(m.shape.mean_bias); });
  method_table(
      report, result, "Aggregation: RMSE / RMS, noise removed",
      [](const M& m) { return std::abs(m.aggregation.bias.value_or(0)); },
      [](const M& m) {
        if (!m.aggregation.bias) return std::string("unknown");
        std::string text = bias_text(m.aggregation) + ", mean " + percent(m.aggregation.mean_bias);
        if (m.aggregation_pixels < 0.95)
          text += fmt::format(" ({:.0f} % of pixels)", 100 * m.aggregation_pixels);
        return text;
      });
  method_table(
      report, result, "Sampling: RMSE / RMS of the noise", [](const M& m) { return m.sampling_noise; },
      [](const M& m) { return fmt::format("{:.3f}", m.sampling_noise); });
}

void time_table(HtmlReport& report, const ValidationResult& result) {
  ReportTable table{"CPU seconds and samples per pixel; references with their noise",
                    table_head(result, {"Scene", "reference", "the same, one albedo"}),
                    {}};
  for (const MeshSceneResult& scene : result.meshes) {
    if (scene.methods.empty()) continue;
    const double pixels = scene.reference.image.width() * scene.reference.image.height();
    const auto text = [&](const TimedImage& render) {
      return fmt::format("{:.1f} s, {:.0f} spp", render.cpu_seconds,
                         static_cast<double>(render.samples) / pixels);
    };
    const auto reference = [&](const TimedImage& render) {
      return text(render) + fmt::format(", {:.3f}", noise_of(render.image));
    };
    std::vector<std::string> cells{scene.name, reference(scene.reference), reference(scene.flat_reference)};
    for (const MeshMethodResult& m : scene.methods) cells.push_back(text(m.render));
    table.rows.push_back(std::move(cells));
  }
  report.table(table);
}

void scene_section(HtmlReport& report, const MeshSceneResult& scene) {
  const Image& truth = scene.reference.image;
  const double white = white_level(truth);
  report.heading(scene.title == scene.name ? scene.name : fmt::format("{} ({})", scene.title, scene.name), 3);
  std::vector<ReportImage> images{picture(truth, white, "reference", "reference image of " + scene.name)},
      differences, flat_differences;
  std::size_t composite = 1;
  for (const MeshMethodResult& m : scene.methods) {
    if (m.model.rfind("composite", 0) == 0) composite = images.size();
    images.push_back(picture(m.render.image, white, m.model, m.model + " on " + scene.name));
    differences.push_back(difference_picture(
        m.render.image, truth, white,
        fmt::format("{}: {:.3f}, mean {}", m.model, *m.errors.bias, percent(m.errors.mean_bias)),
        "signed difference of " + m.model + " from the reference on " + scene.name));
    flat_differences.push_back(difference_picture(
        m.flat_render.image, scene.flat_reference.image, white_level(scene.flat_reference.image),
        fmt::format("{}: {:.3f}, mean {}", m.model, *m.shape.bias, percent(m.shape.mean_bias)),
        "signed difference of " + m.model + " from the reference on one albedo, " + scene.name));
  }
  const std::vector<int> handles = report.images(images, "", picture_width);
  report.slider(handles, scene.name + ", any two", 0, composite);
  report.images(differences,
                "Differences from the reference, blue darker, red brighter, full colour at half of white.",
                picture_width);
  report.images(flat_differences, "The same with one albedo: the part that is due to the shape.",
                picture_width);
}

}  // namespace

void add_mesh_sections(HtmlReport& report, const ValidationResult& result) {
  if (result.meshes.empty()) return;
  report.heading("Meshes: errors");
  report.paragraph(
      "Every method against the volumetric reference: random walks through the mesh that read the albedo at "
      "the "
      "closest point of the surface. Light that was reflected at the surface or crossed it without "
      "scattering is left "
      "out of images and errors; the environment is hidden.");
  list_left_out(report, result.meshes);
  if (table_head(result, {}).empty()) return;
  error_tables(report, result);
  cause_tables(report, result);
  report.heading("Meshes: images");
  for (const MeshSceneResult& scene : result.meshes)
    if (!scene.methods.empty()) scene_section(report, scene);
  report.heading("Meshes: time");
  time_table(report, result);
}

}  // namespace alabaster
