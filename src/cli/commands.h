#pragma once

#include <string>

namespace CLI {
class App;
}

namespace alabaster {

// One function per subcommand, each in a file of its own: it adds the subcommand with its options, and the
// callback that does the work. Errors a user can cause leave as InputError.
void add_all_commands(CLI::App& app);
void add_generate_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_bake_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_batch_command(CLI::App& app);

std::string program_version();
void add_validate_command(CLI::App& app);
void add_profile_command(CLI::App& app);
void add_chart_command(CLI::App& app);

/// What the process ends with when nothing was thrown; a command sets it when part of its work failed.
int exit_code();
void set_exit_code(int code);
/// The work was stopped by Ctrl-C; what was done is written.
inline constexpr int interrupted_exit_code = 130;

}  // namespace alabaster
