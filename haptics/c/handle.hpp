#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <new>
#include <string_view>

#include "engine/core/error.hpp"
#include "haptics/c/sulcus.h"

namespace sulcus {

/// Writes one line of text into a caller's bytes, cut where there is no room for all of it, always
/// with its closing 0; nothing into none.
inline void write_text(std::string_view text, char* to, std::size_t size) noexcept {
  if (!to || size == 0) return;
  const std::size_t kept = text.size() < size ? text.size() : size - 1;
  text.copy(to, kept);
  to[kept] = '\0';
}

/// Does what may throw, and says it as a code.
template <class Call>
int guarded(const Call& call, char* error = nullptr, std::size_t error_size = 0) noexcept {
  try {
    return call();
  } catch (const InputError& why) {
    write_text(why.what(), error, error_size);
    return SULCUS_BAD_INPUT;
  } catch (const std::bad_alloc&) {
    write_text("out of memory", error, error_size);
  } catch (const std::exception& why) {
    write_text(why.what(), error, error_size);
  } catch (...) {
    write_text("an error that has no text", error, error_size);
  }
  return SULCUS_FAILED;
}

/// Whom a handle belongs to at the moment; nobody waits for it.
class Turn {
 public:
  explicit Turn(std::atomic_flag& taken) noexcept
      : taken_(taken), is_ours_(!taken.test_and_set(std::memory_order_acquire)) {}
  ~Turn() {
    if (is_ours_) taken_.clear(std::memory_order_release);
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  bool is_ours() const { return is_ours_; }

 private:
  std::atomic_flag& taken_;
  bool is_ours_;
};

}  // namespace sulcus
