#pragma once

#include <string>

#include "app/commands/commands.hpp"

namespace sulcus {

// The manual and the completion, made from what --help and the reader of scenes know.

/// What --help says below the commands: exit status, environment, files.
std::string program_footer();

/// sulcus(1), in roff.
std::string program_page(const CLI::App& program);
/// sulcus-COMMAND(1).
std::string command_page(const CLI::App& command);
/// sulcus-scene(5).
std::string scene_page();
/// sulcus-recording(5).
std::string recording_page();

/// For bash, to be sourced: commands, options, what they choose from, files, keys of --set.
std::string bash_completion(const CLI::App& program);

}  // namespace sulcus
