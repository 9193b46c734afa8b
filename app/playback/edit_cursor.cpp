#include "app/playback/edit_cursor.hpp"

#include <algorithm>
#include <string>

#include "engine/core/error.hpp"
#include "engine/volume/level_changes.hpp"

namespace sulcus {

namespace {

/// The first so many of each, in the order of `in_order`. Levels are read by parts: hundreds may
/// fall in a tick.
std::vector<Edit> first_edits(const RecordingReader& reader, std::size_t gone_count,
                              std::size_t fill_count) {
  constexpr std::size_t kAtOnce = std::size_t{1} << 16;
  std::vector<Edit> gone = reader.edits(0, gone_count);
  if (fill_count == 0) return gone;
  std::vector<Edit> all;
  all.reserve(gone.size() + fill_count);
  auto next = gone.begin();
  for (std::size_t first = 0; first < fill_count; first += kAtOnce) {
    for (const Edit& fill : reader.fills(first, std::min(kAtOnce, fill_count - first))) {
      while (next != gone.end() && next->tick < fill.tick) all.push_back(*next++);
      all.push_back(fill);
    }
  }
  all.insert(all.end(), next, gone.end());
  return all;
}

/// Of each edit's voxel the level that it had before.
std::vector<FillLevel> levels_before(const std::string& path, std::span<const Edit> edits,
                                     std::span<const VoxelModel* const> start) {
  std::vector<LevelChanges> bodies;
  for (const VoxelModel* body : start) bodies.emplace_back(*body);
  std::vector<FillLevel> levels;
  levels.reserve(edits.size());
  for (const Edit& edit : edits) {
    if (edit.body >= bodies.size()) {
      levels.push_back(kFullLevel);
      continue;
    }
    const VoxelModel& model = *start[edit.body];
    const bool was_solid = model.solid(model.grid.cell_of_linear(edit.voxel));
    levels.push_back(was_solid ? bodies[edit.body].before(edit) : FillLevel{0});
    if (edit.is_gone() || edit.level < levels.back()) continue;
    throw InputError(path, "/fills",
                     "level " + std::to_string(edit.level) + " in tick " +
                         std::to_string(edit.tick) + " of a voxel that has " +
                         std::to_string(levels.back()),
                     "a lower one");
  }
  return levels;
}

}  // namespace

std::vector<Edit> recorded_edits(const RecordingReader& reader, std::size_t row) {
  const std::uint64_t gone = reader.ticks(row, 1).at(0).edits_end;
  const std::uint64_t fills = reader.has_fills() ? reader.fill_ends(row, 1).at(0).fills_end : 0;
  return first_edits(reader, static_cast<std::size_t>(gone), static_cast<std::size_t>(fills));
}

EditCursor::EditCursor(const RecordingReader& reader, std::span<const VoxelModel* const> start)
    : edits_(first_edits(reader, reader.edit_count(), reader.fill_count())) {
  for (const TickRecord& row : reader.ticks()) ends_.push_back(row.edits_end);
  if (!reader.has_fills()) return;
  const std::vector<FillEndRow> fills = reader.fill_ends();
  for (std::size_t row = 0; row < ends_.size(); ++row) ends_[row] += fills[row].fills_end;
  levels_before_ = levels_before(reader.path(), edits_, start);
}

}  // namespace sulcus
