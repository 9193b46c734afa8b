#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace sulcus {

/// Asks for huge pages where an array fills one: what a tick reads here and there, from more pages
/// of 4 KiB than the processor keeps the addresses of, then costs no walk for each. A page is taken
/// whole when its first byte is written, so this is for what is filled as a scene loads, not for
/// what a tick fills. Where the system has none to give, or is told not to, the array is as any
/// other.
template <class T>
struct HugePageAllocator {
  using value_type = T;
  static constexpr std::size_t kHugePage = std::size_t{2} << 20;

  HugePageAllocator() = default;
  template <class U>
  HugePageAllocator(const HugePageAllocator<U>&) noexcept {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes < kHugePage) return std::allocator<T>().allocate(count);
    void* const memory = ::operator new (bytes, std::align_val_t{kHugePage});
#ifdef __linux__
    madvise(memory, bytes, MADV_HUGEPAGE);  // what it returns changes nothing
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) noexcept {
    if (count * sizeof(T) < kHugePage) return std::allocator<T>().deallocate(memory, count);
    ::operator delete (memory, std::align_val_t{kHugePage});
  }
  bool operator==(const HugePageAllocator&) const = default;
};

template <class T>
using HugePageVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace sulcus
