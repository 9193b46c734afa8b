#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/edit.hpp"

namespace sulcus {

/// The last edits of a run, by their numbers from 0. Takes memory when it is made, never after.
class EditLog {
 public:
  static constexpr std::uint64_t kKept = std::uint64_t{1} << 18;

  EditLog() : kept_(kKept) {}

  void add(std::span<const Edit> edits) noexcept {
    for (const Edit& edit : edits) kept_[end_++ % kKept] = edit;
  }
  /// From here on; those before are no longer known.
  void begin_at(std::uint64_t number) noexcept { first_ = end_ = number; }

  std::uint64_t end() const { return end_; }
  /// The earliest that is still known.
  std::uint64_t begin() const { return std::max(first_, end_ - std::min(end_, kKept)); }
  /// One of begin() to end().
  const Edit& operator[](std::uint64_t number) const { return kept_[number % kKept]; }

 private:
  std::vector<Edit> kept_;
  std::uint64_t first_ = 0, end_ = 0;
};

}  // namespace sulcus
