#include "study/validation_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "image/exr_file.h"

namespace alabaster {

namespace {

using Json = nlohmann::ordered_json;

double known(const std::optional<double>& value) {
  return value.value_or(0);
}

/// What every row of results.json has.
Json basic_row(const std::string& scene, const MethodResult& method) {
  const Metrics& e = method.errors;
  return {{"scene", scene},
          {"model", method.model},
          {"rmse_over_rms", e.rmse_over_rms},
          {"bias", known(e.bias)},
          {"noise", known(e.noise)},
          {"mean_bias", e.mean_bias},
          {"mean_abs_log_ratio", e.mean_abs_log_ratio},
          {"kept", e.kept},
          {"seconds", method.render.seconds},
          {"cpu_seconds", method.render.cpu_seconds},
          {"samples", method.render.samples},
          {"bias_interval", known(e.bias_interval)},
          {"mean_bias_interval", known(e.mean_bias_interval)},
          {"log_interval", known(e.log_interval)}};
}

Json row(const SceneResult& scene, const MethodResult& method) {
  Json row = basic_row(scene.scene.name, method);
  row["floor_rmse_over_rms"] = scene.floor.errors.rmse_over_rms;
  row["floor_mean_abs_log_ratio"] = scene.floor.errors.mean_abs_log_ratio;
  row["reference_cpu_seconds"] = scene.reference.cpu_seconds;
  row["reference_paths"] = scene.reference.samples;
  return row;
}

Json row(const MeshSceneResult& scene, const MeshMethodResult& method) {
  Json row = basic_row(scene.name, method);
  const auto add_cause = [&](const std::string& cause, const Metrics& m) {
    row[cause + "_bias"] = known(m.bias);
    row[cause + "_bias_interval"] = known(m.bias_interval);
    row[cause + "_mean_bias"] = m.mean_bias;
    row[cause + "_mean_bias_interval"] = known(m.mean_bias_interval);
  };
  add_cause("shape", method.shape);
  add_cause("aggregation", method.aggregation);
  row["aggregation_pixels"] = method.aggregation_pixels;
  row["sampling_noise"] = method.sampling_noise;
  row["reference_noise"] = noise_of(scene.reference.image);
  row["reference_cpu_seconds"] = scene.reference.cpu_seconds;
  row["reference_paths"] = scene.reference.samples;
  return row;
}

Json all_rows(const ValidationResult& result) {
  Json rows = Json::array();
  for (const SceneResult& scene : result.scenes) {
    for (const MethodResult& method : scene.methods) rows.push_back(row(scene, method));
    for (const MethodResult& method : scene.sweep) rows.push_back(row(scene, method));
  }
  for (const MeshSceneResult& scene : result.meshes)
    for (const MeshMethodResult& method : scene.methods) rows.push_back(row(scene, method));
  return rows;
}

/// One line per row, one column per key of any row; empty where a row lacks it.
std::string to_csv(const Json& rows) {
  std::vector<std::string> keys;
  for (const Json& r : rows)
    for (const auto& [key, value] : r.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  std::string text;
  for (const std::string& key : keys) text += (text.empty() ? "" : ",") + key;
  if (!text.empty()) text += '\n';
  for (const Json& r : rows) {
    std::string line;
    for (const std::string& key : keys) {
      if (key != keys.front()) line += ',';
      if (r.contains(key)) line += r[key].is_string() ? r[key].get<std::string>() : r[key].dump();
    }
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

/// Writes images of one scene into its folder.
class SceneFolder {
 public:
  SceneFolder(std::filesystem::path folder, const std::string& scene, uint64_t seed)
      : folder_(std::move(folder)), common_{{"scene", scene}, {"seed", std::to_string(seed)}} {}

  void write(const std::string& name, const TimedImage& render) const {
    ExrAttributes attributes = common_;
    attributes["model"] = name;
    attributes["samples"] = std::to_string(render.samples);
    write_exr(folder_ / (file_name_of(name) + ".exr"), render.image, attributes);
  }

 private:
  std::filesystem::path folder_;
  ExrAttributes common_;
};

void write_images(const SceneResult& scene, const ValidationOptions& options) {
  const std::string& name = scene.scene.name;
  const SceneFolder folder(options.output / file_name_of(name), name, options.seed);
  folder.write("reference", scene.reference);
  for (const MethodResult& method : scene.methods) folder.write(method.model, method.render);
}

void write_images(const MeshSceneResult& scene, const ValidationOptions& options) {
  if (scene.methods.empty()) return;
  const SceneFolder folder(options.output / file_name_of(scene.name), scene.name, options.seed);
  folder.write("reference", scene.reference);
  folder.write("reference-one-albedo", scene.flat_reference);
  for (const MeshMethodResult& method : scene.methods) {
    folder.write(method.model, method.render);
    folder.write(method.model + "-one-albedo", method.flat_render);
  }
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
  for (const SceneResult& scene : result.scenes) write_images(scene, options);
  for (const MeshSceneResult& scene : result.meshes) write_images(scene, options);
  for (std::size_t i = 0; i < result.maps.size(); ++i)
    for (const auto& [name, image] : result.maps[i].maps)
      write_exr(options.output / file_name_of(result.maps[i].scene) /
                    fmt::format("kernel{}-{}.exr", i + 1, file_name_of(name)),
                image);
}

}  // namespace alabaster
