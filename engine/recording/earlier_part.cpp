#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/hash.hpp"
#include "engine/recording/hdf5_fixed.hpp"
#include "engine/recording/recording_format.hpp"
#include "engine/recording/recording_parts.hpp"

namespace sulcus {

namespace {

constexpr std::uint64_t kMaxNameBytes = 1 << 16;
constexpr hsize_t kMaxEdits = std::uint64_t{1} << 34;  // 16 bodies of 1024^3 voxels

/// use(name of the attribute, number of the measures), in the layout's order.
template <class Measures, class Use>
void for_each_count(Measures& m, const Use& use) {
  use("ticks", m.ticks);
  use("ticks_in_contact", m.ticks_in_contact);
  use("limited_ticks", m.limited_ticks);
  use("buzz_ticks", m.buzz_ticks);
  use("silent_ticks", m.silent_ticks);
  use("jumped_ticks", m.jumped_ticks);
  use("long_step_ticks", m.long_step_ticks);
  use("inside_ticks", m.inside_ticks);
}

template <class Measures, class Use>
void for_each_force(Measures& m, const Use& use) {
  use("peak_force_N", m.peak_force_N);
  use("force_in_contact_sum_N", m.force_in_contact_sum_N);
}

std::uint64_t check_of(const EarlierRun& earlier) {
  std::uint64_t hash = hash_bytes(earlier.recording.data(), earlier.recording.size());
  hash = hash_bytes(earlier.scene_sha256.data(), earlier.scene_sha256.size(), hash);
  const auto add = [&](const char*, const auto& value) {
    hash = hash_bytes(&value, sizeof value, hash);
  };
  for_each_count(earlier.measures, add);
  for_each_force(earlier.measures, add);
  return hash;
}

/// The leaves of the workpiece that edits are of, and nothing else of it.
VoxelModel touched_leaves(const VoxelModel& start, std::span<const Edit> edits) {
  VoxelModel touched = start;
  touched.leaves.assign(start.leaves.size(), LeafBits{});
  for (const Edit& edit : edits) {
    if (edit.body != 0) continue;
    const std::uint32_t leaf = start.grid.leaf_of(start.grid.cell_of_linear(edit.voxel));
    touched.leaves[leaf] = start.leaves[leaf];
  }
  return touched;
}

/// `now` with some of its leaves as they were, tissues of what has gone since among it.
VoxelModel as_it_was(const VoxelModel& now, const VoxelModel& touched) {
  if (touched.grid.cells != now.grid.cells || !touched.tissues != !now.tissues) {
    throw Hdf5Error("earlier/workpiece: another grid or tissues than of the workpiece");
  }
  VoxelModel start = now;
  std::shared_ptr<TissueMap> tissues;
  if (now.tissues) tissues = std::make_shared<TissueMap>(now.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < now.leaves.size(); ++leaf) {
    const VoxelModel& from = any(touched.leaves[leaf]) ? touched : now;
    start.leaves[leaf] = from.leaves[leaf];
    if (!tissues) continue;
    if (const LabelBlock* block = from.tissues->block(leaf)) {
      tissues->set_block(leaf, *block, from.leaves[leaf]);
    } else {
      tissues->set_uniform(leaf, from.tissues->uniform_label(leaf));
    }
  }
  start.tissues = std::move(tissues);
  return start;
}

std::vector<Edit> read_edits(const Hdf5Handle& group, std::span<const VoxelGrid> grids,
                             std::uint64_t file_bytes) {
  const Hdf5Handle type = row_type<EditRow>();
  const auto rows = read_fixed_rows<EditRow>(group, {"edits", type, 1, kMaxEdits}, file_bytes);
  std::vector<Edit> edits;
  edits.reserve(rows.size());
  for (const EditRow& row : rows) {
    if (!is_intact(row, grids) || (!edits.empty() && row.tick < edits.back().tick)) {
      throw Hdf5Error("earlier/edits: row " + std::to_string(edits.size()) + " is damaged");
    }
    edits.push_back(unpacked(row));
  }
  return edits;
}

/// Each edit takes a voxel that is there, and what is left is `now`.
void check_edits(VoxelModel model, std::span<const Edit> edits, const VoxelModel& now) {
  for (const Edit& edit : edits) {
    if (edit.body != 0) continue;
    const Cell c = model.grid.cell_of_linear(edit.voxel);
    if (!model.solid(c)) throw Hdf5Error("earlier/edits: a voxel removed that is not there");
    model.set(c, false);
  }
  if (model.leaves != now.leaves) {
    throw Hdf5Error("earlier/edits: they do not lead to the workpiece");
  }
}

}  // namespace

void write_earlier(const Hdf5Handle& file, const EarlierRun& earlier) {
  const auto group = create_group(file, "earlier");
  write_text_attribute(group, "recording", earlier.recording);
  write_text_attribute(group, "scene_sha256", earlier.scene_sha256);
  for_each_count(earlier.measures, [&](const char* name, const std::uint64_t& count) {
    write_attribute(group, name, H5T_STD_U64LE, &count);
  });
  for_each_force(earlier.measures, [&](const char* name, const double& force) {
    write_attribute(group, name, H5T_IEEE_F64LE, &force);
  });
  write_check(group, check_of(earlier));
  std::vector<EditRow> rows;
  rows.reserve(earlier.edits.size());
  for (const Edit& edit : earlier.edits) rows.push_back(packed(edit));
  write_fixed_rows(group, "edits", row_type<EditRow>(), rows.data(), rows.size());
  write_model(group, "workpiece", touched_leaves(earlier.start, earlier.edits));
}

std::optional<EarlierRun> read_earlier(const Hdf5Handle& file, const VoxelModel& now,
                                       std::span<const VoxelGrid> grids, std::uint64_t file_bytes) {
  const auto group = open_group_if(file, "earlier");
  if (!group.valid()) return {};
  EarlierRun earlier;
  earlier.recording = read_text_attribute(group, "recording", kMaxNameBytes);
  earlier.scene_sha256 = read_text_attribute(group, "scene_sha256", kMaxNameBytes);
  for_each_count(earlier.measures, [&](const char* name, std::uint64_t& count) {
    read_attribute(group, name, H5T_NATIVE_UINT64, &count);
  });
  for_each_force(earlier.measures, [&](const char* name, double& force) {
    read_attribute(group, name, H5T_NATIVE_DOUBLE, &force);
    if (!std::isfinite(force)) throw Hdf5Error("earlier: a force that is not finite");
  });
  verify_check(group, "earlier", check_of(earlier));
  earlier.edits = read_edits(group, grids, file_bytes);
  earlier.start = as_it_was(now, read_model(group, "workpiece", file_bytes));
  check_edits(earlier.start, earlier.edits, now);
  return earlier;
}

}  // namespace sulcus
