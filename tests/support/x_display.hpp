#pragma once

#include <array>
#include <csignal>
#include <string>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace sulcus::test {

/// An X server of its own without a screen, gone with it.
class XDisplay {
 public:
  explicit XDisplay(const char* screen = "800x600x24") {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) return;
    server_ = fork();
    if (server_ == 0) {
      const int nowhere = open("/dev/null", O_RDWR);
      dup2(nowhere, STDOUT_FILENO);
      dup2(nowhere, STDERR_FILENO);
      const std::string number = std::to_string(ends[1]);
      execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", screen, "+extension",
             "GLX", nullptr);
      _exit(127);
    }
    close(ends[1]);
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) number_ += c;
    close(ends[0]);
  }
  ~XDisplay() {
    if (server_ <= 0) return;
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
  }
  XDisplay(const XDisplay&) = delete;
  XDisplay& operator=(const XDisplay&) = delete;

  /// Empty where there is none.
  const std::string& number() const { return number_; }
  pid_t process() const { return server_; }

 private:
  pid_t server_ = -1;
  std::string number_;
};

}  // namespace sulcus::test
