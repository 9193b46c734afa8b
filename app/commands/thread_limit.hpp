#pragma once

#include <cstddef>
#include <optional>

#include <tbb/global_control.h>

#include "app/commands/commands.hpp"

namespace sulcus {

/// The option --threads of a command, 0 where it is not given.
inline void add_threads_option(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads for loading and meshing (all cores)")
      ->type_name("N")
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
