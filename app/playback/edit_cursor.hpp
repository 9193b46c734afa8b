#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/volume/edit.hpp"

namespace sulcus {

/// The edits of a recording, and how many of them a shape has seen: any time of it is reached by
/// going on or back from where it is.
class EditCursor {
 public:
  explicit EditCursor(std::vector<Edit> edits) : edits_(std::move(edits)) {}

  std::span<const Edit> edits() const { return edits_; }
  std::uint64_t at() const { return at_; }
  /// Those from `first` to before `end`, as far as there are.
  std::span<const Edit> between(std::uint64_t first, std::uint64_t end) const {
    const auto last = std::min<std::uint64_t>(end, edits_.size());
    return std::span(edits_).subspan(std::min(first, last), last - std::min(first, last));
  }

  /// To where the first `end` of them have been made: `apply` each on the way on, `take_back` each
  /// on the way back, the latest first.
  template <class Apply, class TakeBack>
  void seek(std::uint64_t end, const Apply& apply, const TakeBack& take_back) {
    end = std::min<std::uint64_t>(end, edits_.size());
    for (; at_ < end; ++at_) apply(edits_[at_]);
    for (; at_ > end; --at_) take_back(edits_[at_ - 1]);
  }
  /// The shape has seen them otherwise: a tick made them again.
  void pass(std::uint64_t end) { at_ = end; }

 private:
  std::vector<Edit> edits_;
  std::uint64_t at_ = 0;
};

}  // namespace sulcus
