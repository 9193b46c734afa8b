#pragma once

#include <cstdint>
#include <string>

namespace sulcus::lab {

/// Counts the instructions of the calling thread, outside the kernel, where the system lets it
/// (perf_event_open; virtual machines often have no such counter). Else it reads 0.
class InstructionCounter {
 public:
  InstructionCounter();
  ~InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  /// Since it was made.
  std::uint64_t read() const noexcept;
  /// Why it does not count; empty where it does.
  const std::string& refused() const { return refused_; }

 private:
  int file_ = -1;
  std::string refused_;
};

}  // namespace sulcus::lab
