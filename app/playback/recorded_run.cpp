#include "app/playback/recorded_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

Scene recorded_scene(const RecordingReader& reader, const std::string& path) {
  return parse_scene(reader.header().scene_toml, path);
}

Burr recorded_burr(const RecordingReader& reader, const Scene& scene) {
  if (std::optional<TriangleMesh> mesh = reader.burr_mesh()) {
    return make_burr(scene.burr, scene.workpiece.voxel_m, std::move(*mesh), scene.file);
  }
  return make_burr(scene.burr, scene.workpiece.voxel_m, scene.file);
}

namespace {

void check_grid(const Scene& scene, const std::string& place, const VoxelGrid& grid,
                const WorkpieceSettings& solid) {
  if (grid.cells == solid.cells && std::abs(grid.voxel_m - solid.voxel_m) < 1e-9 * solid.voxel_m) {
    return;
  }
  throw InputError(scene.file, place, "another grid", "that of its scene");
}

void check_tissues(const Scene& scene, const std::string& place, const VoxelModel& model,
                   std::size_t tissues) {
  const int labels = model.tissues ? model.tissues->label_count() : 1;
  if (static_cast<std::size_t>(labels) <= tissues) return;
  throw InputError(scene.file, place, "the tissue " + std::to_string(labels - 1),
                   std::to_string(tissues) + " of them, as in its scene");
}

}  // namespace

VoxelModel recorded_workpiece(const RecordingReader& reader, const Scene& scene) {
  check_grid(scene, "/workpiece", reader.grid(), scene.workpiece);
  VoxelModel model = reader.workpiece();
  check_tissues(scene, "/workpiece", model, scene.tissues.size());
  return model;
}

std::vector<VoxelModel> recorded_bodies(const RecordingReader& reader, const Scene& scene) {
  const std::span others = std::span(reader.grids()).subspan(1);
  if (others.size() != scene.bodies.size()) {
    throw InputError(scene.file, "/bodies", std::to_string(others.size()) + " bodies",
                     std::to_string(scene.bodies.size()) + ", as in its scene");
  }
  const auto place = [](std::size_t body) { return "/bodies/" + std::to_string(body); };
  for (std::size_t i = 0; i < others.size(); ++i) {
    check_grid(scene, place(i), others[i], scene.bodies[i].solid);
  }
  std::vector<VoxelModel> bodies = reader.bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    check_tissues(scene, place(i), bodies[i], scene.bodies[i].tissue ? 1 : scene.tissues.size());
  }
  return bodies;
}

std::shared_ptr<const EarlierRun> recorded_earlier(const RecordingReader& reader,
                                                   const Scene& scene) {
  std::optional<EarlierRun> earlier = reader.earlier();
  if (!earlier) return nullptr;
  check_tissues(scene, "/earlier/workpiece", earlier->start, scene.tissues.size());
  return std::make_shared<const EarlierRun>(std::move(*earlier));
}

std::vector<PedalChange> recorded_pedal(const RecordingReader& reader) {
  std::vector<PedalChange> changes;
  changes.reserve(reader.pedal().size());
  for (const PedalRow& row : reader.pedal()) changes.push_back({row.tick, row.share});
  return changes;
}

RecordedRun open_recorded_run(const std::string& path) {
  RecordingReader reader(path);
  if (reader.tick_count() == 0) throw InputError(path, "/ticks", "no rows", "at least one tick");
  const Scene scene = recorded_scene(reader, path);
  std::vector<TickRecord> rows = reader.ticks();
  const Pose start = pose_of(rows.front().tool_position_m, rows.front().tool_orientation);
  auto simulation = std::make_unique<Simulation>(scene, recorded_workpiece(reader, scene),
                                                 recorded_bodies(reader, scene),
                                                 recorded_burr(reader, scene), StageClock{}, start);
  if (const std::uint64_t first = rows.front().tick; first > 0) {
    const std::vector<KeyframeInfo>& keyframes = reader.keyframes();
    const bool is_there = !keyframes.empty() && keyframes.front().tick + 1 == first;
    const auto state = is_there ? reader.keyframe(keyframes.front()) : std::nullopt;
    if (!state || !simulation->load_state(*state) || simulation->state().tick != first) {
      throw InputError(path, "/keyframes", "no intact state before tick " + std::to_string(first),
                       "that from which the run goes on");
    }
  }
  std::vector<std::optional<Pose>> poses;
  poses.reserve(rows.size());
  for (const TickRecord& row : rows) {
    if (row.faults & kFaultsWithoutPose) {
      poses.emplace_back();
      continue;
    }
    poses.push_back(pose_of(row.device_position_m, row.device_orientation));
    // The row has the pose before; that of the device was not finite, and no contact was looked
    // for.
    if ((row.faults & kFaultNotFinite) != 0 && row.leaves == 0) {
      poses.back()->position.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  std::vector<TakenAnswer> late;
  for (const TakenAnswerRow& row : reader.taken_answers()) late.push_back({row.asked, row.taken});
  auto earlier = recorded_earlier(reader, scene);
  std::vector<PedalChange> pedal = recorded_pedal(reader);
  return {path,
          std::move(reader),
          std::move(simulation),
          std::move(rows),
          std::move(poses),
          std::move(pedal),
          std::move(late),
          std::move(earlier)};
}

namespace {

std::vector<const VoxelModel*> all_bodies(const VoxelModel& first,
                                          std::span<const VoxelModel> others) {
  std::vector<const VoxelModel*> all{&first};
  for (const VoxelModel& other : others) all.push_back(&other);
  return all;
}

}  // namespace

void say_what_is_missing(const RecordingReader& reader) {
  if (!reader.missing().empty()) say_error("sulcus: %s\n", reader.missing().c_str());
}

std::size_t row_at(std::span<const TickRecord> rows, double time_s) {
  const auto after = std::ranges::upper_bound(rows, time_s, {}, &TickRecord::time_s);
  return after == rows.begin() ? 0 : static_cast<std::size_t>(after - rows.begin() - 1);
}

std::size_t asked_row(std::span<const TickRecord> rows, double time_s, const std::string& option,
                      const std::string& path) {
  const TickRecord &first = rows.front(), &last = rows.back();
  const double tick_s = last.tick > 0 ? last.time_s / static_cast<double>(last.tick) : 0.0;
  const double end_s = last.time_s + tick_s;
  constexpr double kRounding_s = 1e-6;  // of what was typed
  if (time_s >= first.time_s - kRounding_s && time_s <= end_s + kRounding_s) {
    return row_at(rows, time_s);
  }
  throw InputError(path, option, formatted("%g s", time_s),
                   formatted("%.6g to %.6g s", first.time_s, end_s));
}

RecordedShape::RecordedShape(const RecordingReader& reader, VoxelModel start,
                             std::span<const VoxelModel> others)
    : model_(std::move(start)), rows_(reader.ticks()), edits_(reader, all_bodies(model_, others)) {}

std::span<const Edit> RecordedShape::seek_row(std::size_t row) {
  const std::uint64_t from = edits_.at();
  edits_.seek(
      edits_.end_of_row(row),
      [&](const Edit& edit) {
        if (edit.body == 0) apply_edit(edit, model_);
      },
      [&](const Edit& edit, FillLevel before) {
        if (edit.body == 0) take_back_edit(edit, before, model_);
      });
  return edits_.between(std::min(from, edits_.at()), std::max(from, edits_.at()));
}

RecordedPieces::RecordedPieces(const RecordingReader& reader)
    : pieces_(reader.pieces()), rows_(reader.piece_poses()) {
  if (pieces_.empty()) return;
  for (const Edit& edit : reader.edits()) {
    if (edit.cause == EditCause::kLoose) loose_voxels_.push_back(edit.voxel);
  }
}

std::vector<std::span<const std::uint32_t>> RecordedPieces::advance_to_tick(std::uint64_t tick) {
  std::vector<std::span<const std::uint32_t>> come;
  const std::span<const std::uint32_t> all = loose_voxels_;
  while (poses_.size() < pieces_.size() && pieces_[poses_.size()].tick <= tick) {
    const PieceRow& piece = pieces_[poses_.size()];
    const std::size_t first = std::min<std::size_t>(piece.first_loose_edit, all.size());
    come.push_back(all.subspan(first, std::min<std::size_t>(piece.voxels, all.size() - first)));
    poses_.emplace_back();
  }
  for (; next_ < rows_.size() && rows_[next_].tick <= tick; ++next_) {
    const PiecePoseRow& row = rows_[next_];
    if (row.piece >= poses_.size()) continue;
    poses_[row.piece] = pose_of(row.position_m, row.orientation);
  }
  return come;
}

}  // namespace sulcus
