#include "app/playback/verify_recording.hpp"

#include <algorithm>
#include <cstring>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>

#include "app/build_info.hpp"
#include "app/playback/recorded_state.hpp"
#include "app/terminal/progress.hpp"

namespace sulcus {

namespace {

/// Name of the first quantity in which two rows of the same tick differ; null: equal bit for bit.
/// Times and the position in the file are no results.
const char* difference(const TickRecord& a, const TickRecord& b) {
  const auto differs = [](const auto& x, const auto& y) {
    return std::memcmp(&x, &y, sizeof(x)) != 0;
  };
  if (a.tick != b.tick) return "tick";
  if (differs(a.time_s, b.time_s)) return "time_s";
  if (differs(a.tool_position_m, b.tool_position_m)) return "tool_position_m";
  if (differs(a.tool_orientation, b.tool_orientation)) return "tool_orientation";
  if (a.contacts != b.contacts) return "contacts";
  if (a.tested != b.tested) return "tested";
  if (a.leaves != b.leaves) return "leaves";
  if (differs(a.contact_force_N, b.contact_force_N)) return "contact_force_N";
  if (differs(a.contact_torque_Nm, b.contact_torque_Nm)) return "contact_torque_Nm";
  if (differs(a.force_N, b.force_N)) return "force_N";
  if (differs(a.torque_Nm, b.torque_Nm)) return "torque_Nm";
  if (a.removed != b.removed) return "removed";
  if ((a.faults ^ b.faults) & ~std::uint64_t{kFaultRowsDropped}) return "faults";
  return nullptr;
}

/// The search for loose pieces, run again beside the ticks.
class LooseAgain {
 public:
  LooseAgain(const RecordedRun& run)
      : finder_(run.simulation->workpiece().model()),
        schedule_(run.taken_answers, run.rows.front().tick) {}

  std::span<const std::uint32_t> before_tick(std::uint64_t tick) {
    return schedule_.before_tick(tick, [this](LooseAnswer& answer) {
      if (answers_.empty()) return false;
      answer = std::move(answers_.front());
      answers_.pop_front();
      return true;
    });
  }
  void add_tick(std::uint64_t tick, std::span<const Edit> edits) {
    if (auto found = finder_.add_tick(tick, edits)) answers_.push_back(std::move(*found));
  }

 private:
  LooseFinder finder_;
  LooseSchedule schedule_;
  std::deque<LooseAnswer> answers_;
};

class Verification {
 public:
  explicit Verification(RecordedRun& run) : run_(run), state_(run) {}

  Verified all(std::size_t first_row) {
    if (run_.simulation->workpiece().hash_with_tissues() != run_.reader.header().workpiece_hash) {
      throw std::runtime_error(run_.path +
                               ": the workpiece at the start differs from what was run");
    }
    std::optional<LooseAgain> loose;
    if (first_row > 0) {
      state_.seek_row(first_row);
      check_hash(first_row);
    } else if (run_.simulation->scene().loose_pieces) {
      loose.emplace(run_);
    }
    Progress progress("verifying");
    for (std::size_t row = state_.next_row(); row < run_.rows.size(); row = state_.next_row()) {
      progress.at(row, run_.rows.size());
      if (!state_.follows()) {
        loose.reset();  // it has not seen the edits between
        if (!resume(row)) break;
        continue;
      }
      check_row(row, loose);
    }
    return done_;
  }

 private:
  [[noreturn]] void fail(std::uint64_t tick, const std::string& quantity) const {
    const std::string recorded = run_.reader.header().build;
    throw std::runtime_error(
        run_.path + ": tick " + std::to_string(tick) + " differs in " + quantity +
        (recorded == build_info() ? "" : " (recorded by another build, " + recorded + ")"));
  }

  void check_row(std::size_t row, std::optional<LooseAgain>& loose) {
    const TickRecord& recorded = run_.rows[row];
    const TickRecord again = loose ? state_.step(loose->before_tick(recorded.tick)) : state_.step();
    if (loose) loose->add_tick(recorded.tick, state_.simulation().edits());
    if (const char* quantity = difference(recorded, again)) fail(recorded.tick, quantity);
    if (!state_.same_edits()) {
      fail(recorded.tick,
           run_.reader.has_fills() ? "the voxels removed or lowered" : "the voxels removed");
    }
    check_hash(row);
    ++done_.rows;
    const std::span<const Edit> edits = state_.simulation().edits();
    const auto gone = static_cast<std::size_t>(std::ranges::count_if(edits, &Edit::is_gone));
    done_.edits += gone;
    done_.fills += edits.size() - gone;
  }

  /// Against what was recorded of the state after that row, where that was.
  void check_hash(std::size_t row) {
    const std::uint64_t tick = run_.rows[row].tick;
    const std::vector<StateHash>& hashes = run_.reader.state_hashes();
    while (hash_ < hashes.size() && hashes[hash_].tick < tick) ++hash_;
    if (hash_ == hashes.size() || hashes[hash_].tick != tick) return;
    if (hashes[hash_].volume != state_.simulation().workpiece().hash()) fail(tick, "the volume");
    if (hashes[hash_].state != state_.simulation().state().hash()) fail(tick, "the state");
    ++done_.state_hashes;
  }

  /// From the first state that was recorded from a row on, before the next gap ends it; false where
  /// there is none up to the end.
  bool resume(std::size_t row) {
    for (const KeyframeInfo& keyframe : run_.reader.keyframes()) {
      if (keyframe.tick < run_.rows[row].tick) continue;
      std::size_t at = row;
      while (at < run_.rows.size() && run_.rows[at].tick < keyframe.tick) ++at;
      if (at == run_.rows.size()) continue;
      if (!run_.reader.keyframe(keyframe)) {
        ++done_.damaged_states;
        continue;
      }
      state_.seek_row(at);
      check_hash(at);
      done_.skipped += at + 1 - row;
      return true;
    }
    done_.skipped += run_.rows.size() - row;
    return false;
  }

  RecordedRun& run_;
  RecordedState state_;
  Verified done_;
  std::size_t hash_ = 0;
};

}  // namespace

Verified verify_recording(RecordedRun& run, std::size_t first_row) {
  return Verification(run).all(first_row);
}

}  // namespace sulcus
