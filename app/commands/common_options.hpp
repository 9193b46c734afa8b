#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tbb/global_control.h>

#include "app/commands/commands.hpp"
#include "app/commands/number_within.hpp"
#include "app/commands/shipped_files.hpp"

namespace sulcus {

// Options that several commands have.

inline constexpr const char* kSceneArgument =
    "Scene, .toml, or the name of one that came with the program";
inline constexpr const char* kRecordingArgument = "Recording, .h5, or the folder of a run with one";

/// A name of a file or folder that is empty, as of a variable of a script that was not set, is not
/// taken for none.
inline CLI::Validator some_name() {
  return CLI::Validator(
      [](std::string& given) {
        return given.empty() ? std::string("found no name, expected one") : std::string();
      },
      "");
}

/// An option with a value; `type` names that in the help.
template <class Value>
CLI::Option* add_option(CLI::App& command, const char* name, Value& value, const char* type,
                        const std::string& what) {
  CLI::Option* option = command.add_option(name, value, what)->type_name(type);
  if (std::string_view(type) == "FILE" || std::string_view(type) == "DIR") {
    option->check(some_name());
  }
  return option;
}

inline void add_recording_argument(CLI::App& command, std::string& file) {
  add_option(command, "RECORDING", file, "FILE", kRecordingArgument)
      ->required()
      ->transform(CLI::Validator(
          [](std::string& given) {
            given = recording_file_of(given);
            return std::string();
          },
          ""));
}

/// -o and --force. `usual`: where the results go without them.
inline std::array<CLI::Option*, 2> add_folder_options(CLI::App& command, std::string& folder,
                                                      bool& force, const std::string& usual) {
  return {add_option(command, "-o", folder, "DIR", "Folder for the results (" + usual + ")"),
          command.add_flag("--force", force, "Replace another run in the folder of -o")};
}

/// `pace` keeps what it is where the option is not given.
inline CLI::Option* add_pace_option(CLI::App& command, std::string& pace) {
  const std::string text = "real: 1 tick each 1 / rate_hz; fast: no waiting (" + pace + ")";
  return add_option(command, "--pace", pace, "PACE", text)->check(CLI::IsMember({"real", "fast"}));
}

/// One value a time: without `expected` the option would swallow what follows it.
inline CLI::Option* add_set_option(CLI::App& command, std::vector<std::string>& overrides,
                                   const std::string& text) {
  return add_option(command, "--set", overrides, "TABLE.KEY=VALUE", text)->expected(1)->take_all();
}

/// The option --threads of a command, 0 where it is not given.
inline void add_threads_option(CLI::App& command, int& threads) {
  add_option(command, "--threads", threads, "N", "Threads for loading and meshing (all cores)")
      ->check(CLI::Range(1, 1024));
}

/// Holds oneTBB to so many threads while it lives; to all cores where there are 0.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads) {
    if (threads > 0) {
      limit_.emplace(tbb::global_control::max_allowed_parallelism,
                     static_cast<std::size_t>(threads));
    }
  }

 private:
  std::optional<tbb::global_control> limit_;
};

}  // namespace sulcus
