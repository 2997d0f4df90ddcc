#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "cli/render_job.h"
#include "core/error.h"
#include "core/progress.h"

namespace alabaster {

void add_render_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Render a scene file or a glTF model to an EXR image");
  const auto job = std::make_shared<RenderJob>();
  command->add_option("input", job->input, "SCENE.json, MODEL.glb or MODEL.gltf")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", job->output, "the image to write, OUT.exr")
      ->required()
      ->type_name("FILE");
  for (const RenderOptionInfo& info : render_option_infos()) {
    const std::string name = OptionSource{}.error_prefix(info.name);
    if (info.value.empty())
      command->add_flag_callback(
          name, [job, &info] { job->texts[info.name] = "true"; }, info.help);
    else
      command
          ->add_option_function<std::string>(
              name, [job, &info](const std::string& text) { job->texts[info.name] = text; }, info.help)
          ->type_name(info.value);
  }
  command->callback([job] {
    set_quiet(job->texts.count("quiet") > 0);
    SceneCache scenes;
    if (!run_render_job(*job, scenes)) set_exit_code(interrupted_exit_code);
  });
}

}  // namespace alabaster
