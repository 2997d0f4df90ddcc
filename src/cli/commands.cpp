#include "cli/commands.h"

#include <CLI/CLI.hpp>

namespace alabaster {

namespace {
int process_exit_code = 0;
}

void add_all_commands(CLI::App& app) {
  add_generate_command(app);
  add_info_command(app);
  add_compare_command(app);
  add_bake_command(app);
  add_profile_command(app);
  add_render_command(app);
  add_batch_command(app);
  add_validate_command(app);
  add_chart_command(app);
}

std::string program_version() {
  return ALABASTER_VERSION;
}

int exit_code() {
  return process_exit_code;
}
void set_exit_code(int code) {
  process_exit_code = code;
}

}  // namespace alabaster
