#include "study/validation_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "image/exr_file.h"

namespace alabaster {

namespace {

using Json = nlohmann::ordered_json;

/// One row of results.json; `errors` against the reference of `scene`.
Json row(const SceneResult& scene, const MethodResult& method) {
  const ImageErrors& e = method.errors;
  return {{"scene", scene.scene.name},
          {"model", method.model},
          {"rmse_over_rms", e.rmse_over_rms},
          {"bias", e.bias},
          {"noise", e.noise},
          {"mean_bias", e.mean_bias},
          {"mean_abs_log_ratio", e.mean_abs_log_ratio},
          {"kept", e.kept},
          {"seconds", method.render.seconds},
          {"cpu_seconds", method.render.cpu_seconds},
          {"samples", method.render.samples},
          {"bias_interval", e.bias_interval},
          {"mean_bias_interval", e.mean_bias_interval},
          {"log_interval", e.log_interval},
          {"floor_rmse_over_rms", scene.floor.errors.rmse_over_rms},
          {"floor_mean_abs_log_ratio", scene.floor.errors.mean_abs_log_ratio},
          {"reference_cpu_seconds", scene.reference.cpu_seconds},
          {"reference_paths", scene.reference.samples}};
}

Json all_rows(const ValidationResult& result) {
  Json rows = Json::array();
  for (const SceneResult& scene : result.scenes) {
    for (const MethodResult& method : scene.methods) rows.push_back(row(scene, method));
    for (const MethodResult& method : scene.sweep) rows.push_back(row(scene, method));
  }
  return rows;
}

std::string to_csv(const Json& rows) {
  std::string text;
  if (rows.empty()) return text;
  for (const auto& [key, value] : rows.front().items()) text += (text.empty() ? "" : ",") + key;
  text += '\n';
  for (const Json& r : rows) {
    std::string line;
    for (const auto& [key, value] : r.items())
      line += (line.empty() ? "" : ",") + (value.is_string() ? value.get<std::string>() : value.dump());
    text += line + '\n';
  }
  return text;
}

std::string footprint_csv(const ValidationResult& result) {
  std::string text =
      "albedo,max_order,distance,paths,vertices_per_path,inside,mean_along,deviation_along,deviation_across,"
      "w1,w2,w3,t1,t2,t3,log_likelihood_gain\n";
  for (std::size_t i = 0; i < result.footprints.size(); ++i)
    for (const Footprint& f : result.footprints[i])
      text += fmt::format(
          "{},{},{},{},{:.4g},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}\n",
          result.footprint_options[i].albedo, result.footprint_options[i].max_order, f.distance, f.paths,
          f.vertices_per_path, f.inside, f.mean_along, f.deviation_along, f.deviation_across, f.fit.weight[0],
          f.fit.weight[1], f.fit.weight[2], f.fit.position[0], f.fit.position[1], f.fit.position[2],
          f.log_likelihood_gain);
  return text;
}

void write_images(const SceneResult& scene, const std::filesystem::path& folder, uint64_t seed) {
  const ExrAttributes common{{"scene", scene.scene.name}, {"seed", std::to_string(seed)}};
  const auto write = [&](const std::string& name, const TimedImage& render) {
    ExrAttributes attributes = common;
    attributes["model"] = name;
    attributes["samples"] = std::to_string(render.samples);
    write_exr(folder / (file_name_of(name) + ".exr"), render.image, attributes);
  };
  write("reference", scene.reference);
  for (const MethodResult& method : scene.methods) write(method.model, method.render);
}

}  // namespace

std::string file_name_of(const std::string& name) {
  std::string result = name;
  for (char& c : result)
    if (c == ':' || c == '/' || c == '\\' || c == ' ' || c == '@') c = '-';
  return result;
}

void write_validation(const ValidationResult& result, const ValidationOptions& options) {
  const Json rows = all_rows(result);
  write_text_atomically(options.output / "results.json", rows.dump(1) + "\n");
  write_text_atomically(options.output / "results.csv", to_csv(rows));
  if (!result.footprints.empty())
    write_text_atomically(options.output / "footprint.csv", footprint_csv(result));
  for (const SceneResult& scene : result.scenes)
    write_images(scene, options.output / file_name_of(scene.scene.name), options.seed);
  for (std::size_t i = 0; i < result.maps.size(); ++i)
    for (const auto& [name, image] : result.maps[i].maps)
      write_exr(options.output / file_name_of(result.maps[i].scene) /
                    fmt::format("kernel{}-{}.exr", i + 1, file_name_of(name)),
                image);
}

}  // namespace alabaster
