#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "cli/commands.h"
#include "core/cancellation.h"
#include "core/error.h"
#include "core/progress.h"
#include "study/demo_recipe.h"
#include "texture/patterns.h"

namespace alabaster {

namespace {

constexpr std::size_t most_triangles = 20'000'000;

struct GenerateOptions {
  std::vector<std::string> names{"scenes"};
  std::string folder = ".";
  bool list = false;
  std::optional<std::size_t> triangles;
  bool plain = false;
};

bool is_pattern(const std::string& name) {
  const auto& patterns = pattern_names();
  return std::find(patterns.begin(), patterns.end(), name) != patterns.end();
}

/// Names of groups replaced by what they hold.
std::vector<std::string> expand(const std::vector<std::string>& names) {
  std::vector<std::string> result;
  for (const std::string& name : names) {
    const bool all = name == "all";
    if (all || name == "scenes") result.insert(result.end(), recipe_names().begin(), recipe_names().end());
    if (all || name == "textures")
      result.insert(result.end(), pattern_names().begin(), pattern_names().end());
    if (!all && name != "scenes" && name != "textures") result.push_back(name);
  }
  return result;
}

void write_scene(const SceneRecipe& recipe, const std::string& folder) {
  const std::string stem = (std::filesystem::path(folder) / recipe.id).string();
  write_scene_files(recipe, folder);
  std::size_t triangles = 0;
  for (const RecipePart& part : recipe.parts) triangles += part.mesh.triangle_count();
  say(fmt::format("{0}.glb, {0}.json: {1}, {2} triangles", stem, recipe.title, triangles));
}

void generate(const GenerateOptions& options) {
  if (options.list) {
    for (const std::string& name : expand({"all"})) fmt::print("{}\n", name);
    return;
  }
  if (options.triangles || options.plain) {
    if (options.names != std::vector<std::string>{"blob"})
      throw InputError("--triangles and --plain: only the scene 'blob' can be had so; ask for it alone");
    const std::size_t triangles = options.triangles.value_or(15552);
    return write_scene(make_blob_recipe(triangles, !options.plain), options.folder);
  }
  for (const std::string& name : expand(options.names)) {
    const std::string stem = (std::filesystem::path(options.folder) / name).string();
    if (is_pattern(name)) {
      write_pattern_file(name, options.folder);
      say(stem + ".png: albedo texture");
      continue;
    }
    write_scene(make_recipe(name), options.folder);
  }
}

}  // namespace

void add_generate_command(CLI::App& app) {
  auto options = std::make_shared<GenerateOptions>();
  CLI::App* command =
      app.add_subcommand("generate", "Write the procedural scenes (models with scene files) and textures");
  command
      ->add_option("names", options->names, "Which ones, or scenes, textures, all; --list tells their names")
      ->capture_default_str();
  command->add_option("-o,--output", options->folder, "Folder for NAME.glb and NAME.json, or NAME.png")
      ->capture_default_str();
  command->add_option("--triangles", options->triangles, "blob alone: about so many triangles (15552)")
      ->check(CLI::Range(std::size_t{1}, most_triangles))
      ->type_name("N");
  command->add_flag("--plain", options->plain, "blob alone: one albedo, 0.9, instead of a texture");
  command->add_flag("--list", options->list, "Print the names and do nothing else");
  command->callback([options] {
    const PromptExit prompt_exit("alabaster: interrupted; the files named so far are whole\n");
    generate(*options);
  });
}

}  // namespace alabaster
