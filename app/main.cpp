#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "app/build_info.hpp"
#include "app/commands.hpp"
#include "app/manual.hpp"
#include "app/session.hpp"
#include "engine/core/error.hpp"

namespace {

void request_stop(int) { sulcus::stop_requested = true; }

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  std::signal(SIGPIPE, SIG_IGN);  // a chart or video program that goes away is an error, not an end

  CLI::App program("Sulcus: a real-time dental cutting simulator");
  program.name("sulcus");
  program.set_version_flag("--version", sulcus::build_info());
  program.require_subcommand(1);
  sulcus::add_run_command(program);
  sulcus::add_replay_command(program);
  sulcus::add_render_command(program);
  sulcus::add_view_command(program);
  sulcus::add_export_command(program);
  sulcus::add_inspect_command(program);
  sulcus::add_repair_command(program);
  sulcus::add_help_command(program);  // last: it knows the others
  program.footer(sulcus::program_footer());
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "sulcus: %s (see sulcus --help)\n", error.what());
    return 2;
  } catch (const sulcus::InputError& error) {
    std::fprintf(stderr, "sulcus: %s\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "sulcus: out of memory\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sulcus: %s\n", error.what());
    return 1;
  }
  return 0;
}
