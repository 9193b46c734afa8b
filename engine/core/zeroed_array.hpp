#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace sulcus {

/// An array whose elements are zero until they are written; T{} must be all zero bytes. Where the
/// system gives pages as they are first written, those that never are take no memory, in a copy
/// neither: for arrays of which most stays zero. Throws std::bad_alloc.
template <class T>
class ZeroedArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;

  ZeroedArray() = default;
  explicit ZeroedArray(std::size_t count) : size_(count) {
    if (count == 0) return;
    // Room to begin where T may lie: calloc knows nothing of its alignment.
    if (count > (SIZE_MAX - alignof(T)) / sizeof(T)) throw std::bad_alloc();
    std::size_t bytes = count * sizeof(T) + alignof(T);
    memory_.reset(std::calloc(bytes, 1));
    if (!memory_) throw std::bad_alloc();
    void* begin = memory_.get();
    elements_ = static_cast<T*>(std::align(alignof(T), count * sizeof(T), begin, bytes));
  }
  ZeroedArray(const ZeroedArray& other) : ZeroedArray(other.size_) { take_from(other); }
  ZeroedArray(ZeroedArray&& other) noexcept
      : memory_(std::move(other.memory_)),
        elements_(std::exchange(other.elements_, nullptr)),
        size_(std::exchange(other.size_, 0)) {}
  ZeroedArray& operator=(ZeroedArray other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(elements_, other.elements_);
    std::swap(size_, other.size_);
    return *this;
  }

  /// Keeps what it has of so many.
  void resize(std::size_t count) {
    ZeroedArray resized(count);
    resized.take_from(*this);
    *this = std::move(resized);
  }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Of the elements; what of them the system has given is less.
  std::size_t bytes() const { return size_ * sizeof(T); }
  T* data() { return elements_; }
  const T* data() const { return elements_; }
  T& operator[](std::size_t n) { return elements_[n]; }
  const T& operator[](std::size_t n) const { return elements_[n]; }
  T* begin() { return elements_; }
  T* end() { return elements_ + size_; }
  const T* begin() const { return elements_; }
  const T* end() const { return elements_ + size_; }

  bool operator==(const ZeroedArray& other) const {
    if (size_ != other.size_) return false;
    for (std::size_t n = 0; n < size_; ++n) {
      if (!(elements_[n] == other[n])) return false;
    }
    return true;
  }

 private:
  struct Free {
    void operator()(void* memory) const noexcept { std::free(memory); }
  };

  /// This is zero as yet.
  void take_from(const ZeroedArray& other) {
    for (std::size_t n = 0; n < std::min(size_, other.size_); ++n) {
      if (!(other[n] == T{})) elements_[n] = other[n];
    }
  }

  std::unique_ptr<void, Free> memory_;
  T* elements_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace sulcus
