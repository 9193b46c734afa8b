#include "tests/support/command.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <sys/wait.h>

namespace sulcus::test {

int CommandResult::err_lines() const {
  return static_cast<int>(std::count(err.begin(), err.end(), '\n'));
}

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

CommandResult program_command(const std::string& program, const std::string& arguments,
                              const std::string& scratch, const std::string& environment) {
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

CommandResult sulcus_command(const std::string& arguments, const std::string& scratch,
                             const std::string& environment) {
  return program_command(SULCUS_PROGRAM, arguments, scratch, environment);
}

}  // namespace sulcus::test
