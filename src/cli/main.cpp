#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

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
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const alabaster::InputError& error) {
    std::fprintf(stderr, "alabaster: %s\n", error.what());
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
