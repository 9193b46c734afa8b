#include "haptics/loose_schedule.hpp"

#include <algorithm>
#include <limits>

namespace sulcus {

std::optional<LooseAnswer> LooseFinder::add_tick(std::uint64_t tick, std::span<const Edit> edits) {
  removed_.clear();
  for (const Edit& edit : edits) {
    if (edit.body == 0 && edit.is_gone()) removed_.push_back(edit.voxel);
  }
  pieces_.remove(removed_);
  if (!asks_after(tick)) return {};
  LooseAnswer answer;
  answer.asked = tick;
  for (const LoosePiece& piece : pieces_.take()) {
    answer.voxels.insert(answer.voxels.end(), piece.voxels.begin(), piece.voxels.end());
    answer.ends.push_back(answer.voxels.size());
  }
  return answer;
}

LooseSchedule::LooseSchedule(std::span<const TakenAnswer> played_back, std::uint64_t first)
    : LooseSchedule(first) {
  plays_back_ = true;
  for (const TakenAnswer& answer : played_back) taken_by_asked_[answer.asked] = answer.taken;
}

std::uint64_t LooseSchedule::due() const {
  if (!plays_back_) return asked_ + kAnswerAfter;
  const auto found = taken_by_asked_.find(asked_);
  return found == taken_by_asked_.end() ? std::numeric_limits<std::uint64_t>::max() : found->second;
}

std::span<const std::uint32_t> LooseSchedule::next_voxels() {
  while (!leaving_.empty() && next_ == leaving_.front().voxels.size()) {
    leaving_.pop_front();
    next_ = 0;
  }
  if (leaving_.empty()) return {};
  const std::span<const std::uint32_t> all(leaving_.front().voxels);
  const auto voxels = all.subspan(next_, std::min(kLeavePerTick, all.size() - next_));
  next_ += voxels.size();
  left_ += voxels.size();
  return voxels;
}

}  // namespace sulcus
