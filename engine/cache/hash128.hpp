#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include <Eigen/Core>
#include <xxhash.h>

namespace sulcus {

/// XXH3-128: wide enough to name contents by, faster than memory.
struct Hash128 {
  std::uint64_t low = 0, high = 0;
  bool operator==(const Hash128&) const = default;
};

/// 32 lower-case hexadecimal digits.
std::string hex(const Hash128& hash);

/// The hash of values given one after another. Texts and optional values are told apart by their
/// length or presence, so that what follows cannot be taken for a part of them.
class Hash128Stream {
 public:
  Hash128Stream();

  Hash128Stream& add_bytes(const void* data, std::size_t bytes);
  Hash128Stream& add(std::string_view text);
  Hash128Stream& add(const Hash128& hash) { return add(hash.low).add(hash.high); }
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T> Hash128Stream& add(T value) {
    return add_bytes(&value, sizeof value);
  }
  template <class T, int kRows>
  Hash128Stream& add(const Eigen::Matrix<T, kRows, 1>& vector) {
    for (T value : vector) add(value);
    return *this;
  }
  template <class T>
  Hash128Stream& add(const std::optional<T>& value) {
    add(value.has_value());
    return value ? add(*value) : *this;
  }
  Hash128 result() const;

 private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> state_;
};

/// Hash of a file's contents; empty where it cannot be read.
std::optional<Hash128> hash_file(const std::string& path);

}  // namespace sulcus
