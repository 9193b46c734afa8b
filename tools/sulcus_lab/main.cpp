#include <cstdio>
#include <exception>
#include <new>

#include <CLI/CLI.hpp>

#include "app/build_info.hpp"
#include "app/terminal/standard_streams.hpp"
#include "engine/core/error.hpp"
#include "engine/core/stop.hpp"
#include "tools/sulcus_lab/commands.hpp"

namespace {

/// The exit status.
int run(int argc, char** argv) {
  CLI::App program("Sulcus's measuring program: speed and accuracy, one against the other");
  program.name("sulcus-lab");
  program.set_version_flag("--version", sulcus::build_info());
  program.require_subcommand(1);
  sulcus::lab::add_fractions_command(program);
  sulcus::lab::add_frames_command(program);
  sulcus::lab::add_laws_command(program);
  sulcus::lab::add_normals_command(program);
  sulcus::lab::add_pareto_command(program);
  sulcus::lab::add_program_command(program);
  sulcus::lab::add_reality_command(program);
  sulcus::lab::add_recordings_command(program);
  sulcus::lab::add_stability_command(program);
  sulcus::lab::add_table1_command(program);
  sulcus::lab::add_ticks_command(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "sulcus-lab: %s (see sulcus-lab --help)\n", error.what());
    return 2;
  } catch (const sulcus::InputError& error) {
    std::fprintf(stderr, "sulcus-lab: %s\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "sulcus-lab: out of memory\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sulcus-lab: %s\n", error.what());
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  sulcus::make_streams_safe();
  sulcus::watch_for_stop();
  const int status = run(argc, argv);
  if (sulcus::has_said_all() || status != 0) return status;
  std::fprintf(stderr, "sulcus-lab: standard output: cannot be written\n");
  return 1;
}
