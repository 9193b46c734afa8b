#pragma once

#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <sys/wait.h>

namespace sulcus::test {

/// What a command of the program did.
struct CommandResult {
  int status = -1;
  std::string out, err;

  int err_lines() const {
    int lines = 0;
    for (char c : err) lines += c == '\n';
    return lines;
  }
};

inline std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Runs a program with arguments for a shell; `scratch` is a path for what it says on its error
/// stream. The user's load cache is left alone, unless the environment names another one.
inline CommandResult program_command(const std::string& program, const std::string& arguments,
                                     const std::string& scratch,
                                     const std::string& environment = "SULCUS_CACHE=off") {
  const std::string command =
      "env " + environment + " " + program + " " + arguments + " 2>'" + scratch + "' </dev/null";
  CommandResult result;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error("no shell");
  std::array<char, 4096> buffer{};
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    result.out.append(buffer.data(), n);
  }
  const int ended = pclose(pipe);
  result.status = WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended);
  result.err = read_file(scratch);
  return result;
}
/// The same of the built `sulcus`.
inline CommandResult sulcus_command(const std::string& arguments, const std::string& scratch,
                                    const std::string& environment = "SULCUS_CACHE=off") {
  return program_command(SULCUS_PROGRAM, arguments, scratch, environment);
}

}  // namespace sulcus::test
