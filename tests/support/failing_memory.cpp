#include "tests/support/failing_memory.hpp"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

std::atomic<sulcus::test::NoMemory> no_memory{sulcus::test::NoMemory::kNobody};
constinit thread_local bool marked = false;

void* take(std::size_t bytes, std::size_t alignment) {
  using sulcus::test::NoMemory;
  const NoMemory whose = no_memory.load(std::memory_order_relaxed);
  if (whose == (marked ? NoMemory::kMarkedThreads : NoMemory::kOtherThreads)) {
    throw std::bad_alloc();
  }
  void* block = nullptr;
  if (posix_memalign(&block, alignment, bytes == 0 ? 1 : bytes) != 0) throw std::bad_alloc();
  return block;
}

void* take_or_null(std::size_t bytes, std::size_t alignment) noexcept {
  try {
    return take(bytes, alignment);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

}  // namespace

namespace sulcus::test {

void set_no_memory(NoMemory whose) noexcept { no_memory = whose; }
void mark_this_thread() noexcept { marked = true; }

}  // namespace sulcus::test

// In place of the library's for the whole program; the forms for arrays call these, or are a
// sanitizer's own. Those that do not throw are here, too: a sanitizer's would not go with our
// delete.
void* operator new(std::size_t bytes) { return take(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return take(bytes, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return take_or_null(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return take_or_null(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
void operator delete(void* block, std::align_val_t) noexcept { std::free(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { std::free(block); }
