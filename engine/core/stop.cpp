#include "engine/core/stop.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <pthread.h>
#include <unistd.h>

namespace sulcus {
namespace {

std::atomic<int> signal_come{0};

/// What a stop finds. Held by the watching thread from then on until the process has ended, so that
/// nobody makes a file or a child that is not on the lists.
struct Lists {
  std::mutex mutex;
  std::vector<std::string> files;
  std::vector<pid_t> children;
  int ending_themselves = 0;
};

/// Never destroyed: the watching thread may be at work while the process ends.
Lists& lists() {
  static Lists& made = *new Lists;
  return made;
}

sigset_t stop_signals() {
  sigset_t all;
  sigemptyset(&all);
  sigaddset(&all, SIGINT);
  sigaddset(&all, SIGTERM);
  struct sigaction on_hangup {};
  const bool outlives_terminal =
      sigaction(SIGHUP, nullptr, &on_hangup) == 0 && on_hangup.sa_handler == SIG_IGN;
  if (!outlives_terminal) sigaddset(&all, SIGHUP);
  return all;
}

[[noreturn]] void end_process(Lists& held) {
  for (const std::string& file : held.files) ::unlink(file.c_str());
  for (const pid_t child : held.children) ::kill(child, SIGKILL);
  constexpr std::string_view kClear = "\r\033[K", kLine = "sulcus: stopped\n";
  const auto say = [](std::string_view text) {
    [[maybe_unused]] const ssize_t said = ::write(STDERR_FILENO, text.data(), text.size());
  };
  if (::isatty(STDERR_FILENO) == 1) say(kClear);  // a line of progress
  say(kLine);
  ::_exit(stop_status());
}

void* watch(void*) {
  const sigset_t all = stop_signals();
  for (;;) {
    int signal = 0;
    if (sigwait(&all, &signal) != 0) continue;
    const bool again = stop_requested();
    // A terminal that goes away says so twice: through its shell, and when that has ended.
    if (again && signal == SIGHUP) continue;
    signal_come = signal;
    Lists& found = lists();
    found.mutex.lock();
    if (again || found.ending_themselves == 0) end_process(found);
    found.mutex.unlock();
  }
}

}  // namespace

void watch_for_stop() {
  const sigset_t all = stop_signals();
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  // It needs little, and what it has is locked into memory with the rest at real pace.
  constexpr std::size_t kStack = 256 * 1024;
  pthread_attr_setstacksize(&attributes, kStack);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_t thread{};
  const int error = pthread_create(&thread, &attributes, watch, nullptr);
  pthread_attr_destroy(&attributes);
  if (error != 0) throw std::runtime_error("no thread could be started");
}

bool stop_requested() noexcept { return signal_come.load(std::memory_order_relaxed) != 0; }

int stop_status() noexcept { return 128 + signal_come.load(); }

void pretend_stop(bool requested) noexcept { signal_come = requested ? SIGINT : 0; }

EndsItself::EndsItself() {
  const std::lock_guard lock(lists().mutex);
  ++lists().ending_themselves;
}

EndsItself::~EndsItself() {
  const std::lock_guard lock(lists().mutex);
  --lists().ending_themselves;
}

void remove_when_stopped(const std::string& path) {
  const std::lock_guard lock(lists().mutex);
  lists().files.push_back(path);
}

void keep_when_stopped(const std::string& path) {
  const std::lock_guard lock(lists().mutex);
  std::erase(lists().files, path);
}

void kill_when_stopped(pid_t process) {
  const std::lock_guard lock(lists().mutex);
  lists().children.push_back(process);
}

void leave_when_stopped(pid_t process) {
  const std::lock_guard lock(lists().mutex);
  std::erase(lists().children, process);
}

}  // namespace sulcus
