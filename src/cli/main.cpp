#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "cli/commands.h"
#include "core/cancellation.h"
#include "core/error.h"

int main(int argc, char** argv) {
  CLI::App app{"Alabaster renders spatially varying subsurface scattering on textured glTF meshes."};
  app.set_version_flag("--version", ALABASTER_VERSION);
  app.require_subcommand(1);
  alabaster::add_all_commands(app);
  alabaster::install_cancellation_handler();
  try {
    // CLI11 would say that a subcommand is missing.
    const auto is_named = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_named).empty())
      throw alabaster::InputError(argv[1], "there is no such subcommand; alabaster --help lists them");
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const alabaster::InputError& error) {
    std::fprintf(stderr, "alabaster: %s\n", error.what());
    return 1;
  } catch (const std::filesystem::filesystem_error& error) {
    std::fprintf(stderr, "alabaster: %s: %s\n", error.path1().c_str(), error.code().message().c_str());
    return 1;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "alabaster: out of memory; try a smaller --size\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "alabaster: internal error: %s\n", error.what());
    return 3;
  }
  return alabaster::exit_code();
}
