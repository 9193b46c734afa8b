#pragma once

#include <CLI/CLI.hpp>

namespace sulcus {

// One file per command. Each adds its subcommand with its options to the program; when it is the
// one called, its callback does the work and throws InputError (status 2) or another std::exception
// (status 1).
void add_run_command(CLI::App& program);
void add_replay_command(CLI::App& program);
void add_render_command(CLI::App& program);
void add_view_command(CLI::App& program);
void add_repair_command(CLI::App& program);
void add_export_command(CLI::App& program);
void add_assess_command(CLI::App& program);
void add_inspect_command(CLI::App& program);
/// Of those that were added before it.
void add_help_command(CLI::App& program);

}  // namespace sulcus
