#include "app/loose_schedule.hpp"

#include <algorithm>

namespace sulcus {

std::optional<LooseAnswer> LooseFinder::add_tick(std::uint64_t tick, std::span<const Edit> edits) {
  removed_.clear();
  for (const Edit& edit : edits) removed_.push_back(edit.voxel);
  pieces_.remove(removed_);
  if (!asks_after(tick)) return {};
  return LooseAnswer{tick, pieces_.take()};
}

LooseSchedule::LooseSchedule(std::span<const LateAnswer> late) {
  for (const LateAnswer& answer : late) late_[answer.asked] = answer.taken;
  find_due();
}

void LooseSchedule::find_due() {
  const auto late = late_.find(asked_);
  due_ = late == late_.end() ? asked_ + kAnswerAfter : late->second;
}

void LooseSchedule::add(const LooseAnswer& answer, std::uint64_t tick) {
  if (tick > asked_ + kAnswerAfter) late_now_.push_back({asked_, tick});
  for (const LoosePiece& piece : answer.pieces) {
    leaving_.insert(leaving_.end(), piece.voxels.begin(), piece.voxels.end());
  }
  asked_ += kAskEvery;
  find_due();
}

std::span<const std::uint32_t> LooseSchedule::next_voxels() {
  if (next_ == leaving_.size()) {
    leaving_.clear();
    next_ = 0;
    return {};
  }
  const std::size_t count = std::min(kLeavePerTick, leaving_.size() - next_);
  const std::span<const std::uint32_t> voxels(leaving_.data() + next_, count);
  next_ += count;
  left_ += count;
  return voxels;
}

}  // namespace sulcus
