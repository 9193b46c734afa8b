#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "app/build_info.hpp"
#include "app/commands/commands.hpp"
#include "app/commands/manual.hpp"
#include "app/terminal/standard_streams.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/stop.hpp"

namespace {

int refuse_arguments(const CLI::App& program, int argc, char** argv, const CLI::ParseError& error) {
  const std::vector<CLI::App*> named = program.get_subcommands();
  if (named.empty() && argc > 1 && argv[1][0] != '-') {
    std::string commands;
    for (const CLI::App* command : program.get_subcommands({})) {
      commands += (commands.empty() ? "" : ", ") + command->get_name();
    }
    sulcus::say_error("sulcus: no command '%s': %s (see sulcus --help)\n", argv[1],
                      commands.c_str());
  } else if (named.empty() && argc > 1) {
    sulcus::say_error("sulcus: no option '%s' of the program (see sulcus --help)\n", argv[1]);
  } else {
    const std::string command = named.empty() ? "" : " " + named.front()->get_name();
    sulcus::say_error("sulcus: %s (see sulcus%s --help)\n", error.what(), command.c_str());
  }
  return 2;
}

/// The exit status.
int run(int argc, char** argv) {
  CLI::App program("Sulcus: a real-time dental cutting simulator");
  program.name("sulcus");
  program.set_version_flag("--version", sulcus::build_info());
  program.require_subcommand(1);
  sulcus::add_run_command(program);
  sulcus::add_replay_command(program);
  sulcus::add_render_command(program);
  sulcus::add_view_command(program);
  sulcus::add_export_command(program);
  sulcus::add_assess_command(program);
  sulcus::add_inspect_command(program);
  sulcus::add_repair_command(program);
  sulcus::add_help_command(program);  // last: it knows the others
  program.footer(sulcus::program_footer());
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    return refuse_arguments(program, argc, argv, error);
  } catch (const sulcus::InputError& error) {
    sulcus::say_error("sulcus: %s\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    sulcus::say_error("sulcus: out of memory\n");
    return 1;
  } catch (const std::exception& error) {
    sulcus::say_error("sulcus: %s\n", error.what());
    return 1;
  }
  return sulcus::stop_requested() ? sulcus::stop_status() : 0;
}

}  // namespace

int main(int argc, char** argv) {
  sulcus::make_streams_safe();
  sulcus::watch_for_stop();
  sulcus::give_back_large_blocks();
  const int status = run(argc, argv);
  if (sulcus::has_said_all() || status != 0) return status;
  sulcus::say_error("sulcus: standard output: cannot be written\n");
  return 1;
}
