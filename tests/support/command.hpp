#pragma once

#include <string>

namespace sulcus::test {

/// What a command of the program did.
struct CommandResult {
  int status = -1;
  std::string out, err;

  int err_lines() const;
};

std::string read_file(const std::string& path);

/// Runs a program with arguments for a shell; `scratch` is a path for what it says on its error
/// stream. The user's load cache is left alone, unless the environment names another one.
CommandResult program_command(const std::string& program, const std::string& arguments,
                              const std::string& scratch,
                              const std::string& environment = "SULCUS_CACHE=off");
/// The same of the built `sulcus`.
CommandResult sulcus_command(const std::string& arguments, const std::string& scratch,
                             const std::string& environment = "SULCUS_CACHE=off");

}  // namespace sulcus::test
