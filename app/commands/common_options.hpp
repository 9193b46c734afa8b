#pragma once

#include <string>
#include <vector>

#include "app/commands/commands.hpp"

namespace sulcus {

// Options that several commands have.

inline constexpr const char* kSceneArgument =
    "Scene, .toml, or the name of one that came with the program";
inline constexpr const char* kRecordingArgument = "Recording, .h5";

inline void add_recording_argument(CLI::App& command, std::string& file) {
  command.add_option("RECORDING", file, kRecordingArgument)->required()->type_name("FILE");
}

/// `pace` keeps what it is where the option is not given.
inline CLI::Option* add_pace_option(CLI::App& command, std::string& pace) {
  const std::string text = "real: 1 tick each 1 / rate_hz; fast: no waiting (" + pace + ")";
  return command.add_option("--pace", pace, text)
      ->type_name("PACE")
      ->check(CLI::IsMember({"real", "fast"}));
}

/// Beside -o.
inline CLI::Option* add_force_option(CLI::App& command, bool& force) {
  return command.add_flag("--force", force, "Replace another run in the folder of -o");
}

/// One value a time: without `expected` the option would swallow what follows it.
inline CLI::Option* add_set_option(CLI::App& command, std::vector<std::string>& overrides,
                                   const std::string& text) {
  return command.add_option("--set", overrides, text)
      ->type_name("TABLE.KEY=VALUE")
      ->expected(1)
      ->take_all();
}

}  // namespace sulcus
