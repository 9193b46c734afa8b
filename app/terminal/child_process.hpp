#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace sulcus {

/// Another program beside this one (gnuplot, ffmpeg). Its arguments are data: no shell reads them.
/// What it is left with when this ends is killed. One thread uses one of these at a time.
class ChildProcess {
 public:
  /// Open file descriptors that become the child's; below 0: nothing, as /dev/null.
  struct Files {
    int in = -1, out = -1, error = -1;
  };

  /// Looks `arguments[0]` up in PATH. @throws std::runtime_error where it cannot be started; the
  /// message names it and the reason.
  ChildProcess(const std::vector<std::string>& arguments, const Files& files);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits for its end. Its exit status; 128 and the number of the signal that ended it.
  int wait();

 private:
  pid_t process_ = -1;  // below 0: waited for
};

}  // namespace sulcus
