#pragma once

namespace sulcus::test {

/// Whose `new` finds no memory (std::bad_alloc), in programs that have failing_memory.cpp.
enum class NoMemory { kNobody, kMarkedThreads, kOtherThreads };
void set_no_memory(NoMemory whose) noexcept;
/// Marks the calling thread.
void mark_this_thread() noexcept;

}  // namespace sulcus::test
