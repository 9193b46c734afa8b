#pragma once

#include <string>

#include <sys/types.h>

namespace sulcus {

// How a command is stopped by SIGINT (Ctrl-C), SIGTERM or SIGHUP (its terminal went away). There is
// one way:
//
//   signal --> watching thread --+-- a command that ends itself (EndsItself): it sees
//                                |   stop_requested(), keeps its results and returns
//                                +-- any other: files that are not whole are removed, child
//                                    processes killed, and the process ends at once
//
// Either way the exit status is 128 and the signal's number. No code outside has to look at
// anything between its steps, so that a command stops as soon inside a library as in ours. A
// second signal but SIGHUP ends also what ends itself.

/// Takes the signals over for the rest of the process: blocks them in the calling thread, so that
/// every later thread has them blocked too, and starts the watching thread. SIGHUP stays ignored
/// where it is (nohup). Once, at the start of main, before any other thread.
void watch_for_stop();

/// Whether the process was asked to stop. Any thread.
bool stop_requested() noexcept;
/// The exit status of a command that was stopped: 129, 130 or 143.
int stop_status() noexcept;
/// As if SIGINT had come to what ends itself, or none: for tests.
void pretend_stop(bool requested) noexcept;

/// While one of these lives the command ends by itself once stop_requested(). Any thread.
class EndsItself {
 public:
  EndsItself();
  ~EndsItself();
  EndsItself(const EndsItself&) = delete;
  EndsItself& operator=(const EndsItself&) = delete;
};

// Told by WholeFile and ChildProcess. Any thread but the haptic one.

/// A file to be removed where the process is stopped, until keep_when_stopped(). Before it is made,
/// so that none is left behind.
void remove_when_stopped(const std::string& path);
void keep_when_stopped(const std::string& path);
/// A child to be killed where the process is stopped, until leave_when_stopped().
void kill_when_stopped(pid_t process);
void leave_when_stopped(pid_t process);

}  // namespace sulcus
