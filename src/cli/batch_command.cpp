#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "cli/commands.h"
#include "cli/render_job.h"
#include "core/atomic_file.h"
#include "core/cancellation.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "scene/json_reader.h"

namespace alabaster {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct BatchArguments {
  fs::path file;
  std::optional<fs::path> output_folder;
  bool resume = false, quiet = false;
};

// Text of an option as the command line would have it; arrays become comma-separated.
std::string option_text(const json& value, const OptionSource& source, const std::string& key) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean() || value.is_number()) return value.dump();
  if (!value.is_array())
    throw InputError(source.error_prefix(key), "must be a text, a number, true or false");
  std::string text;
  for (const json& element : value) text += (text.empty() ? "" : ",") + option_text(element, source, key);
  return text;
}

fs::path absolute_from(const fs::path& folder, const std::string& path) {
  return (folder / path).lexically_normal();
}

RenderJob read_job(const json& defaults, const json& job, const OptionSource& source,
                   const BatchArguments& arguments) {
  if (!job.is_object()) throw InputError(source.file, source.place, "must be an object");
  json merged = defaults;
  merged.update(job);
  const fs::path input_folder = arguments.file.parent_path();
  const fs::path output_folder = arguments.output_folder.value_or(input_folder);
  RenderJob result;
  result.source = source;
  for (const auto& [key, value] : merged.items()) {
    const std::string text = option_text(value, source, key);
    if (key == "input")
      result.input = absolute_from(input_folder, text);
    else if (key == "output")
      result.output = absolute_from(output_folder, text);
    else if (key == "png")
      result.texts[key] = absolute_from(output_folder, text).string();
    else if (key == "subsurface_map")
      result.texts[key] = absolute_from(input_folder, text).string();
    else
      result.texts[key] = text;
  }
  for (const char* key : {"input", "output"})
    if (!merged.contains(key)) throw InputError(source.error_prefix(key), "is missing");
  return result;
}

json read_jobs(const fs::path& file) {
  json root = parse_json(file.string(), read_text(file));
  if (!root.is_object() || !root.contains("jobs") || !root["jobs"].is_array())
    throw InputError(file.string(), R"(must hold {"defaults": {...}, "jobs": [{...}]})");
  for (const auto& [key, value] : root.items())
    if (key != "defaults" && key != "jobs") throw InputError(file.string(), key, "there is no such key");
  if (!root.contains("defaults")) root["defaults"] = json::object();
  if (!root["defaults"].is_object()) throw InputError(file.string(), "defaults", "must be an object");
  return root;
}

// Runs the jobs one after the other, all threads on each.
class Batch {
 public:
  explicit Batch(const BatchArguments& arguments) : arguments_(arguments) {}

  void run() {
    const double start = wall_seconds();
    const json root = read_jobs(arguments_.file);
    for (const json& entry : root["jobs"]) plan(root["defaults"], entry);
    for (std::size_t i = 0; i < planned_.size() && !interrupted_ && !cancellation_requested(); ++i) {
      attempt(i);
      release_scene(i);
    }
    summarise(wall_seconds() - start);
  }

 private:
  struct Planned {
    std::optional<RenderJob> job;
    std::string scene;    // key in the cache
    std::string problem;  // why there is no job
  };

  // A job that cannot be understood fails when its turn comes, like any other.
  void plan(const json& defaults, const json& entry) {
    const OptionSource source{arguments_.file.string(), fmt::format("job {}", planned_.size() + 1)};
    Planned planned;
    try {
      RenderJob job = read_job(defaults, entry, source, arguments_);
      RenderSettings settings;
      apply_options(job.texts, source, settings);
      if (!outputs_.insert(job.output).second)
        throw InputError(source.error_prefix("output"), job.output.string() + " is an earlier job's as well");
      planned.scene = SceneCache::key(job.input, settings.load);
      planned.job = std::move(job);
    } catch (const InputError& error) {
      planned.problem = error.what();
    }
    planned_.push_back(std::move(planned));
  }

  void attempt(std::size_t i) {
    try {
      if (!planned_[i].job) throw InputError(planned_[i].problem);
      run_one(*planned_[i].job, fmt::format("job {} of {}", i + 1, planned_.size()));
    } catch (const InputError& error) {
      failed(i + 1, error.what());
    } catch (const std::bad_alloc&) {
      failed(i + 1, "out of memory; try a smaller size");
    } catch (const std::exception& error) {
      failed(i + 1, std::string("internal error: ") + error.what());
    }
  }

  void run_one(const RenderJob& job, const std::string& label) {
    if (arguments_.resume && is_finished(job)) {
      ++skipped_;
      say(fmt::format("{}: {} is finished, skipped", label, job.output.string()));
      return;
    }
    say(fmt::format("{}: {}", label, job.output.string()));
    if (run_render_job(job, scenes_))
      ++done_;
    else
      interrupted_ = true;
  }

  // A scene that no later job needs is let go.
  void release_scene(std::size_t i) {
    for (std::size_t later = i + 1; later < planned_.size(); ++later)
      if (planned_[later].scene == planned_[i].scene) return;
    scenes_.release(planned_[i].scene);
  }

  void failed(std::size_t job, const std::string& message) {
    ++failed_;
    warn(fmt::format("job {} failed: {}", job, message));
  }

  void summarise(double seconds) {
    interrupted_ |= cancellation_requested();
    const std::size_t left = planned_.size() - done_ - skipped_ - failed_;
    say(fmt::format("batch: {} rendered, {} skipped, {} failed{} in {}", done_, skipped_, failed_,
                    left > 0 ? fmt::format(", {} left", left) : "", format_duration(seconds)));
    if (interrupted_)
      set_exit_code(interrupted_exit_code);
    else if (failed_ > 0)
      set_exit_code(1);
  }

  const BatchArguments& arguments_;
  std::vector<Planned> planned_;
  SceneCache scenes_;
  std::set<fs::path> outputs_;
  std::size_t done_ = 0, skipped_ = 0, failed_ = 0;
  bool interrupted_ = false;
};

}  // namespace

void add_batch_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("batch", "Render a list of jobs, scenes loaded once");
  const auto arguments = std::make_shared<BatchArguments>();
  command->add_option("jobs", arguments->file, "{\"defaults\": {...}, \"jobs\": [{...}]}")
      ->required()
      ->type_name("JOBS.json");
  command
      ->add_option("-o,--output", arguments->output_folder,
                   "folder of the outputs; default: that of the jobs file")
      ->type_name("DIR");
  command->add_flag("--resume", arguments->resume, "skip outputs that are finished");
  command->add_flag("--quiet", arguments->quiet, "warnings and errors only");
  command->callback([arguments] {
    set_quiet(arguments->quiet);
    Batch(*arguments).run();
  });
}

}  // namespace alabaster
