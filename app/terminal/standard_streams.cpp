#include "app/terminal/standard_streams.hpp"

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace sulcus {

void make_streams_safe() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    // The lowest that is closed: this one.
    if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", O_RDWR) != stream) std::_Exit(1);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool has_said_all() {
  const bool failed = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
  struct stat output {};
  return !failed || ::fstat(STDOUT_FILENO, &output) != 0 || S_ISFIFO(output.st_mode) ||
         S_ISSOCK(output.st_mode);
}

}  // namespace sulcus
