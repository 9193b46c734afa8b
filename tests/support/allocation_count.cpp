#include "tests/support/allocation_count.hpp"

#include <cerrno>
#include <cstddef>

namespace {

// Plain and thread-local in the program itself: reading it takes no memory, even inside malloc.
constinit thread_local std::uint64_t count = 0;

}  // namespace

namespace sulcus::test {

std::uint64_t allocation_count() noexcept { return count; }

}  // namespace sulcus::test

#ifdef SULCUS_SANITIZED

// A sanitizer has an allocator of its own, which tells whoever asks.
#include <sanitizer/allocator_interface.h>

namespace {

[[maybe_unused]] const int installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++count; }, [](const volatile void*) {});

}  // namespace

#else

// glibc lets a program put functions of its own before these; operator new calls malloc, and free
// stays glibc's.
extern "C" {

void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t items, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);

void* malloc(std::size_t bytes) {
  ++count;
  return __libc_malloc(bytes);
}
void* calloc(std::size_t items, std::size_t bytes) {
  ++count;
  return __libc_calloc(items, bytes);
}
void* realloc(void* block, std::size_t bytes) {
  ++count;
  return __libc_realloc(block, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  ++count;
  return __libc_memalign(alignment, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) {
  ++count;
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  ++count;
  *block = __libc_memalign(alignment, bytes);
  return *block || bytes == 0 ? 0 : ENOMEM;
}

}  // extern "C"

#endif
