#include "app/terminal/child_process.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/core/stop.hpp"

namespace sulcus {
namespace {

/// Frees what posix_spawn was given.
struct Plan {
  posix_spawn_file_actions_t files{};
  posix_spawnattr_t attributes{};

  Plan() {
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
  }
  ~Plan() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;

  void give(int descriptor, int as, int flags) {
    if (descriptor >= 0) {
      posix_spawn_file_actions_adddup2(&files, descriptor, as);
    } else {
      posix_spawn_file_actions_addopen(&files, as, "/dev/null", flags, 0);
    }
  }
};

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, const Files& files) {
  Plan plan;
  plan.give(files.in, STDIN_FILENO, O_RDONLY);
  plan.give(files.out, STDOUT_FILENO, O_WRONLY);
  plan.give(files.error, STDERR_FILENO, O_WRONLY);
  // Signals as a program expects them at its start, whatever this one has made of them.
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&plan.attributes, &none);
  posix_spawnattr_setsigdefault(&plan.attributes, &all);
  // In a group of its own: Ctrl-C is for this process, which says what becomes of its children.
  posix_spawnattr_setpgroup(&plan.attributes, 0);
  posix_spawnattr_setflags(&plan.attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (const std::string& argument : arguments) {
    words.push_back(const_cast<char*>(argument.c_str()));
  }
  words.push_back(nullptr);
  pid_t process = -1;
  const int error =
      posix_spawnp(&process, words[0], &plan.files, &plan.attributes, words.data(), environ);
  if (error != 0) {
    throw std::runtime_error(arguments[0] + " could not be started: " + std::strerror(error));
  }
  process_ = process;
  kill_when_stopped(process_);
}

ChildProcess::~ChildProcess() {
  if (process_ < 0) return;
  ::kill(process_, SIGKILL);
  wait();
}

int ChildProcess::wait() {
  // Not under the number of a process that has been waited for, which may be another's by then.
  siginfo_t ended{};
  while (::waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOWAIT) < 0 &&
         errno == EINTR) {
  }
  leave_when_stopped(process_);
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace sulcus
