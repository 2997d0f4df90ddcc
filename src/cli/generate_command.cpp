#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "core/progress.h"
#include "study/demo_recipe.h"

namespace alabaster {

namespace {

struct GenerateOptions {
  std::vector<std::string> names{"all"};
  std::string folder = ".";
  bool list = false;
};

void generate(const GenerateOptions& options) {
  if (options.list) {
    for (const std::string& name : recipe_names()) fmt::print("{}\n", name);
    return;
  }
  std::vector<std::string> names;
  for (const std::string& name : options.names)
    if (name == "all")
      names.insert(names.end(), recipe_names().begin(), recipe_names().end());
    else
      names.push_back(name);
  for (const std::string& name : names) {
    const SceneRecipe recipe = make_recipe(name);
    write_scene_files(recipe, options.folder);
    std::size_t triangles = 0;
    for (const RecipePart& part : recipe.parts) triangles += part.mesh.triangle_count();
    const auto stem = std::filesystem::path(options.folder) / name;
    say(fmt::format("{0}.glb, {0}.json: {1}, {2} triangles", stem.string(), recipe.title, triangles));
  }
}

}  // namespace

void add_generate_command(CLI::App& app) {
  auto options = std::make_shared<GenerateOptions>();
  CLI::App* command = app.add_subcommand("generate", "Write the procedural scenes: models with scene files");
  command->add_option("names", options->names, "Which ones, or all; --list tells their names")
      ->capture_default_str();
  command->add_option("-o,--output", options->folder, "Folder for NAME.glb and NAME.json")
      ->capture_default_str();
  command->add_flag("--list", options->list, "Print the names and do nothing else");
  command->callback([options] { generate(*options); });
}

}  // namespace alabaster
